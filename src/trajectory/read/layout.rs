//! Which kind of file it is.

/// How a trajectory file is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Text: `t,id,x,y,z[,vx,vy,vz]`, or `t,x[,v]`.
    Csv,
    /// NumPy's archive of arrays `t`, `x` and, if wanted, `v`.
    Npz,
    /// One NumPy array: the positions.
    Npy,
}

impl Layout {
    /// By the first bytes, whatever the name says; by the name's extension where they say nothing,
    /// and text where that says nothing either.
    pub fn guess(name: &str, bytes: &[u8]) -> Self {
        let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
            Self::Npz
        } else if bytes.starts_with(b"\x93NUMPY") {
            Self::Npy
        } else if extension.eq_ignore_ascii_case("npz") {
            Self::Npz
        } else if extension.eq_ignore_ascii_case("npy") {
            Self::Npy
        } else {
            Self::Csv
        }
    }
}
