//! What reading a scene costs: a cloth in a few lines, and the same with every member written out. Compare figures of
//! one run only.

#[path = "../tests/testkit/mod.rs"]
mod testkit;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use springcheck::scene::{self, Scene};
use springcheck::verbs;
use std::hint::black_box;
use testkit::cloth::in_few_lines;

fn read(text: &str) -> Scene {
    scene::parse(text.as_bytes(), "bench.yml", verbs::names()).expect("a scene")
}

/// Criterion's elements are particles.
fn loading(c: &mut Criterion) {
    let mut group = c.benchmark_group("loading");
    let mut file = |name: &str, particles: usize, text: &str| {
        group.throughput(Throughput::Elements(particles as u64));
        group.bench_function(name, |b| b.iter(|| read(black_box(text))));
    };
    for n in [100, 316] {
        file(
            &format!("cloth {n} x {n}, an object"),
            n * n,
            &in_few_lines(n),
        );
    }
    let whole = scene::yaml(&read(&in_few_lines(100)));
    file("cloth 100 x 100, written out", 100 * 100, &whole);
    group.finish();
}

criterion_group!(benches, loading);
criterion_main!(benches);
