#![allow(missing_docs, clippy::print_stdout)]
use chaos::test_systems::System;
fn main() { for s in System::ALL { let mut prev = 0.0; let mut v = vec![]; for k in 1..=16 { let c = s.tangent_exponent(10_000 * k) * (k as f64); v.push((c - prev) / s.exponent()); prev = c; }
 let m = v.iter().sum::<f64>() / v.len() as f64; let sd = (v.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (v.len() - 1) as f64).sqrt(); println!("{} mean {m:.4} sd {sd:.4}", s.name()); } }
