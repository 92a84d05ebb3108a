//! A part of the scenes, for one machine among several.

use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A part of all scenes: the `part`th of `parts`, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Partition {
    by: By,
    part: u64,
    parts: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum By {
    /// Every nth, in order: parts of equal size.
    Slice,
    /// By the path alone: a scene stays in its part when others come and go.
    Hash,
}

impl FromStr for Partition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected slice:1/4 or hash:1/4, found `{text}`");
        let (by, share) = text.split_once(':').ok_or_else(wrong)?;
        let by = match by {
            "slice" => By::Slice,
            "hash" => By::Hash,
            _ => return Err(wrong()),
        };
        let (part, parts) = share.split_once('/').ok_or_else(wrong)?;
        let (part, parts) = part
            .parse()
            .ok()
            .zip(parts.parse().ok())
            .ok_or_else(wrong)?;
        if part < 1 || part > parts {
            return Err(format!("expected a part from 1 to {parts}, found {part}"));
        }
        Ok(Self { by, part, parts })
    }
}

impl Partition {
    /// The scenes of this part, in their order.
    pub fn of(self, scenes: &[PathBuf]) -> Vec<PathBuf> {
        let held = |(at, path): &(usize, &PathBuf)| self.holds(*at, path);
        let held = scenes.iter().enumerate().filter(held);
        held.map(|(_, path)| path.clone()).collect()
    }

    fn holds(self, at: usize, path: &Path) -> bool {
        let number = match self.by {
            By::Slice => at as u64,
            By::Hash => {
                let hash = Sha256::digest(path.to_string_lossy().replace('\\', "/").as_bytes());
                hash.iter()
                    .take(8)
                    .fold(0, |sum, byte| sum << 8 | u64::from(*byte))
            }
        };
        number % self.parts == self.part - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_everything_once() {
        let paths: Vec<PathBuf> = (0..57)
            .map(|n| PathBuf::from(format!("scenes/{n}.yml")))
            .collect();
        for by in ["slice", "hash"] {
            let mut sizes = [0; 4];
            for (at, path) in paths.iter().enumerate() {
                let of = |part: usize| format!("{by}:{}/4", part + 1).parse::<Partition>();
                let held: Vec<usize> = (0..4)
                    .filter(|&p| of(p).is_ok_and(|p| p.holds(at, path)))
                    .collect();
                assert_eq!(held.len(), 1, "{path:?}");
                sizes[held[0]] += 1;
            }
            assert!(sizes.iter().all(|&size| size > 4), "{by} {sizes:?}");
        }
        for wrong in [
            "slice",
            "slice:0/4",
            "slice:5/4",
            "hash:1",
            "part:1/2",
            "slice:1/0",
        ] {
            assert!(wrong.parse::<Partition>().is_err(), "{wrong}");
        }
    }
}
