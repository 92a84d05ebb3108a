//! What is stored comes back bit by bit, and only if it is whole.

use super::honesty::times;
use super::problems::shot;
use crate::testkit::swinging_triangle;
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, Scene};
use springcheck::truth::converged::{Converged, NotConverged, find, key};
use springcheck::truth::{Motion, Store};
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

/// Keeps everything and counts.
#[derive(Default)]
struct Memory {
    kept: Mutex<HashMap<String, Vec<u8>>>,
    saves: AtomicU32,
}

impl Memory {
    fn with(key: &str, bytes: &[u8]) -> Self {
        let memory = Self::default();
        memory.keep(key, bytes);
        memory
    }

    fn keep(&self, key: &str, bytes: &[u8]) {
        let mut kept = self.kept.lock().expect("no panic");
        kept.insert(key.into(), bytes.to_vec());
    }

    fn bytes(&self, key: &str) -> Vec<u8> {
        self.load(key).expect("it was saved")
    }

    fn saves(&self) -> u32 {
        self.saves.load(Ordering::SeqCst)
    }
}

impl Store for Memory {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.kept.lock().expect("no panic").get(key).cloned()
    }

    fn save(&self, key: &str, bytes: &[u8]) {
        self.saves.fetch_add(1, Ordering::SeqCst);
        self.keep(key, bytes);
    }
}

fn scene() -> Scene {
    swinging_triangle(0.2, DampingModel::Axial)
}

fn of(scene: &Scene, store: &dyn Store) -> Result<Converged, NotConverged> {
    find(scene, &ParticleSystem::new(scene), UNTIL, store)
}

const UNTIL: f64 = 2.0;

/// Everything a caller can see, bit by bit.
fn seen(found: &Result<Converged, NotConverged>) -> (Vec<String>, Vec<u64>) {
    match found {
        Err(none) => (vec![none.reason.clone()], Vec::new()),
        Ok(c) => {
            let texts = vec![
                c.facts.method.clone(),
                c.facts.reason.clone(),
                format!("{:?}", c.facts.growth),
            ];
            let times = times(UNTIL);
            let states = c.motion.states(&times);
            let bars = times.iter().map(|&t| c.motion.error_bar(t));
            let numbers = [c.facts.horizon, c.facts.error_bound]
                .into_iter()
                .chain(bars);
            let all = numbers.chain(states.x).chain(states.v);
            (
                texts,
                all.map(f64::to_bits).chain([c.facts.spent]).collect(),
            )
        }
    }
}

#[test]
fn a_hit_is_bit_identical_to_a_miss() {
    let mut hopeless = shot(0.0);
    hopeless.springs[0].stiffness = 1e16;
    for scene in [scene(), hopeless] {
        let store = Memory::default();
        let miss = of(&scene, &store);
        assert_eq!(store.saves(), 1);
        let hit = of(&scene, &store);
        assert_eq!(store.saves(), 1, "it was computed again");
        assert_eq!(seen(&hit), seen(&miss));
        // Called otherwise and stepped otherwise it is the same motion.
        let mut renamed = scene.clone();
        renamed.name = "another".into();
        renamed.solver.timestep /= 2.0;
        assert_eq!(seen(&of(&renamed, &store)), seen(&miss));
        assert_eq!(store.saves(), 1);
    }
}

/// Damaged bytes are computed anew, and the damage is repaired.
fn repair_law(damage: &dyn Fn(&mut Vec<u8>)) -> Result<(), String> {
    let scene = scene();
    let name = key(&scene, UNTIL);
    let store = Memory::default();
    let right = of(&scene, &store);
    let whole = store.bytes(&name);
    let mut bytes = whole.clone();
    damage(&mut bytes);
    let damaged = Memory::with(&name, &bytes);
    if seen(&of(&scene, &damaged)) != seen(&right) {
        return Err("wrong bits".into());
    }
    if damaged.saves() != 1 || damaged.bytes(&name) != whole {
        return Err("taken as it was".into());
    }
    Ok(())
}

#[test]
fn damaged_bytes_are_ignored() {
    let length = {
        let store = Memory::default();
        of(&scene(), &store).expect("it converges");
        store.bytes(&key(&scene(), UNTIL)).len()
    };
    for keep in [
        0,
        1,
        7,
        8,
        31,
        32,
        33,
        100,
        length / 2,
        length - 32,
        length - 1,
    ] {
        repair_law(&|bytes| bytes.truncate(keep)).unwrap();
    }
    // Version, key, texts, depths, states, checksum.
    for at in [
        0,
        8,
        30,
        90,
        130,
        200,
        length / 3,
        length / 2,
        length - 40,
        length - 1,
    ] {
        repair_law(&|bytes| bytes[at] ^= 1).unwrap();
    }
    repair_law(&|bytes| bytes.push(0)).unwrap();
    repair_law(&|bytes| bytes.extend(bytes.clone())).unwrap();
    repair_law(&|bytes| bytes.fill(0xff)).unwrap();
    // Whole bytes are taken as they are: the law sees that.
    repair_law(&|_| {}).unwrap_err();
}

#[test]
fn bytes_of_another_scene_are_ignored() {
    let (scene, other) = (scene(), swinging_triangle(0.3, DampingModel::Axial));
    let store = Memory::default();
    let right = of(&scene, &store);
    of(&other, &store).expect("it converges");
    let foreign = store.bytes(&key(&other, UNTIL));
    let name = key(&scene, UNTIL);
    let misplaced = Memory::with(&name, &foreign);
    assert_eq!(seen(&of(&scene, &misplaced)), seen(&right));
    assert_eq!(misplaced.bytes(&name), store.bytes(&name));
}

#[test]
fn many_at_once_get_the_same() {
    let scene = scene();
    let store = Memory::default();
    let all: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| seen(&of(&scene, &store))))
            .collect();
        threads
            .into_iter()
            .map(|thread| thread.join().expect("no panic"))
            .collect()
    });
    assert!(all.iter().all(|one| *one == all[0]));
    // Whoever came last, its bytes are those of the first.
    let alone = Memory::default();
    of(&scene, &alone).expect("it converges");
    let name = key(&scene, UNTIL);
    assert_eq!(store.bytes(&name), alone.bytes(&name));
}
