//! work in progress
use crate::delay::Times;
use crate::error::{Error, checked};
use crate::global_map::*;

#[derive(Clone, Debug, PartialEq)]
pub struct Exponent {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub noise: f64,
    pub details: Vec<Candidate>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    pub dimension: usize,
    pub delay: usize,
    pub count: usize,
    pub ridge: f64,
    pub along: f64,
    pub block_error: f64,
    pub jackknife: f64,
    pub free: Option<f64>,
    pub likelihood: f64,
    pub noise: f64,
    pub model: f64,
}

fn env(name: &str, d: f64) -> f64 { std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(d) }

fn mean(v: &[f64]) -> f64 { v.iter().sum::<f64>() / v.len() as f64 }

pub fn screened(y: &[f64], delays: &[usize], width: f64) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::new();
    for &d in delays {
        for m in 1..=6 {
            let span = (m - 1) * d;
            if y.len() < span + 200 { continue; }
            let rows = y.len() - span - 1;
            let stride = rows.div_ceil(2500);
            let picked: Vec<usize> = (0..rows).step_by(stride).collect();
            let basis = Basis::new(y, m, d, 100.min(picked.len() / 8), width);
            let size = basis.size();
            let mut phi = vec![0.0; picked.len() * size];
            let mut g = vec![0.0; picked.len()];
            let mut z = vec![0.0; m];
            for (k, &r) in picked.iter().enumerate() {
                vector(y, span + r, &basis, &mut z);
                basis.features(&z, &mut phi[k * size..(k + 1) * size]);
                g[k] = y[span + r + 1];
            }
            if let Some(fit) = regress(&phi, size, &g) { found.push((m, d, fit.held_out.sqrt())); }
        }
    }
    found.sort_by(|a, b| a.2.total_cmp(&b.2));
    found
}

pub fn candidate(y: &[f64], m: usize, d: usize, count: usize, width: f64, passes: usize) -> Option<Candidate> {
    let basis = Basis::new(y, m, d, count, width);
    let mut x = y.to_vec();
    let mut fit = fit_once(&basis, y, &x, None, 0.0, 1.0)?;
    let mut best: Option<(f64, f64, f64, Vec<f64>, Fit)> = None;
    let mut center = 0usize;
    let ratios = [0.0, 0.01, 0.1, 1.0, 10.0, 100.0];
    for pass in 0..=passes {
        let (values, slopes) = slopes_along(&basis, &fit.theta, &x);
        let range = if pass == 0 { 0..ratios.len() } else { center.saturating_sub(1)..(center + 2).min(ratios.len()) };
        let mut here: Option<(f64, f64, f64, Vec<f64>)> = None;
        for i in range {
            let (noise, model) = (ratios[i] / (1.0 + ratios[i]), 1.0 / (1.0 + ratios[i]));
            let (xx, like, chi) = smooth_with(&basis, &values, &slopes, y, &x, noise, model);
            if here.as_ref().is_none_or(|h| like > h.0) { here = Some((like, noise * chi, model * chi, xx)); center = i; }
        }
        let (like, s2, q2, xx) = here?;
        if best.as_ref().is_some_and(|b| like < b.0) { break; }
        let old = fit;
        if s2 == 0.0 || pass == passes { best = Some((like, s2, q2, xx, old)); break; }
        x = xx.clone();
        let (_, slopes) = slopes_along(&basis, &old.theta, &x);
        best = Some((like, s2, q2, xx, old));
        fit = fit_once(&basis, y, &x, Some(&slopes), s2, q2)?;
    }
    let (likelihood, s2, q2, x, fit) = best?;
    let along = |theta: &[f64]| exponent_along(&slopes_along(&basis, theta, &x).1, m, d);
    let growth = along(&fit.theta);
    let value = mean(&growth);
    let size = (growth.len() / 20).max(1);
    let blocks: Vec<f64> = growth.chunks_exact(size).map(mean).collect();
    let block_error = (blocks.iter().map(|b| (b - value).powi(2)).sum::<f64>() / ((blocks.len() - 1) * blocks.len()) as f64).sqrt();
    let folds: Vec<f64> = fit.folds.iter().map(|t| mean(&along(t))).collect();
    let middle = mean(&folds);
    let jackknife = (folds.iter().map(|f| (f - middle).powi(2)).sum::<f64>() * (FOLDS as f64 - 1.0) / FOLDS as f64).sqrt();
    let steps = env("FREE", 20000.0) as usize;
    let free = free_run(&basis, &fit.theta, &x[100..], steps, 6.0, 0.0).map(|f| f.0);
    Some(Candidate { dimension: m, delay: d, count, ridge: fit.ridge, along: value, block_error, jackknife, free, likelihood, noise: s2.sqrt(), model: q2.sqrt() })
}

pub fn exponent(signal: &[f64], times: &Times) -> Result<Exponent, Error> {
    let (center, deviation) = checked(signal)?;
    let y: Vec<f64> = signal.iter().map(|v| (v - center) / deviation).collect();
    let width = env("WIDTH", 2.5);
    let jitter = env("JITTER", 0.003);
    let mut generator = <scalar::random::Stream as rand::SeedableRng>::seed_from_u64(0);
    let y: Vec<f64> = y.iter().map(|v| v + jitter * rand::RngExt::sample::<f64, _>(&mut generator, rand_distr::StandardNormal)).collect();
    let mut delays = vec![times.delay.div_ceil(2), times.delay];
    delays.dedup();
    let list = screened(&y, &delays, width);
    let mut details = Vec::new();
    for &(m, d, e) in list.iter().take(env("TAKE", 3.0) as usize) {
        if e > env("CUT", 1.5) * list[0].2 { break; }
        let count = env("COUNT", 150.0) as usize;
        let Some(mut c) = candidate(&y, m, d, count.min(y.len() / 12), width, env("PASSES", 3.0) as usize) else { continue };
        if c.noise < c.model && env("MORE", 0.0) as usize > count {
            if let Some(b) = candidate(&y, m, d, (env("MORE", 0.0) as usize).min(y.len() / 12), width, 3) { c = b; }
        }
        details.push(c);
    }
    details.sort_by(|a, b| b.likelihood.total_cmp(&a.likelihood));
    if details.is_empty() { return Err(Error::NoScalingRegion { reason: "no model" }); }
    let values: Vec<f64> = details.iter().map(|c| c.along).collect();
    let value = mean(&values);
    let c = &details[0];
    let half = 2.1 * c.block_error.hypot(c.jackknife);
    Ok(Exponent { value, low: value - half, high: value + half, noise: c.noise, details })
}
