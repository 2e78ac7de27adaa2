//! The features of a window: four accelerations of 12 000 samples, two seconds at 600 rpm and 6 kHz.

use criterion::{Criterion, criterion_group, criterion_main};
use features::Window;
use signal::channel::Channel;

/// Impacts twice a revolution that ring at 1.8 kHz, over a slow sine.
fn sample(channel: usize, i: usize) -> f32 {
    let since = ((i + 70 * channel) % 300) as f32;
    let slow = (0.01 * i as f32).sin();
    let rough = ((i * i % 1009) as f32 / 1009.0) - 0.5;
    slow + 0.2 * rough + (-0.05 * since).exp() * (1.9 * since).sin()
}

fn window(c: &mut Criterion) {
    let channels: Vec<Channel> = (0..4)
        .map(|channel| Channel {
            name: format!("acceleration_{channel}_m_s2"),
            unit: "m/s^2".to_owned(),
            samples: (0..12_000).map(|i| sample(channel, i)).collect(),
        })
        .collect();
    let window = Window {
        sample_rate: 6000.0,
        speed_rpm: Some(600.0),
        crank_angle: None,
        channels: &channels,
        chambers: &[],
    };
    c.bench_function("window", |b| b.iter(|| features::features(&window)));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).without_plots();
    targets = window
}
criterion_main!(benches);
