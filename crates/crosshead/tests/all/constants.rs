//! A number that is used in several places has one home.

use crate::sources::{crates, modules};
use std::collections::BTreeMap;
use syn::{Expr, Item, Lit, UnOp};

/// Numbers so common that one name for two of them says nothing.
const COMMON: [f64; 4] = [0.0, 1.0, 2.0, 10.0];

#[test]
fn no_number_has_two_homes() {
    let mut homes: BTreeMap<(String, u64), Vec<String>> = BTreeMap::new();
    for folder in crates() {
        for (file, items) in modules(&folder).into_values() {
            for item in items {
                let Item::Const(constant) = item else {
                    continue;
                };
                let Some(value) = number(&constant.expr) else {
                    continue;
                };
                if COMMON.contains(&value) {
                    continue;
                }
                let key = (constant.ident.to_string(), value.to_bits());
                homes
                    .entry(key)
                    .or_default()
                    .push(file.display().to_string());
            }
        }
    }
    let twice: Vec<String> = homes
        .iter()
        .filter(|(_, files)| files.len() > 1)
        .map(|((name, bits), files)| {
            format!("{name} = {}: {}", f64::from_bits(*bits), files.join(", "))
        })
        .collect();
    assert!(twice.is_empty(), "two homes:\n{}", twice.join("\n"));
}

/// The value of a constant that is written as a number.
fn number(expression: &Expr) -> Option<f64> {
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(value) => value.base10_parse().ok(),
            Lit::Float(value) => value.base10_parse().ok(),
            _ => None,
        },
        Expr::Unary(minus) if matches!(minus.op, UnOp::Neg(_)) => number(&minus.expr).map(|x| -x),
        _ => None,
    }
}
