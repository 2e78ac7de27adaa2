//! The source files of a crate, parsed, as a tree of modules.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use syn::{Attribute, Item, Meta};

/// A module's path from its crate's root, `["joints", "contact"]`.
pub type Module = Vec<String>;

/// The folders of all crates.
pub fn crates() -> Vec<PathBuf> {
    let all = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("crates");
    let mut folders: Vec<PathBuf> = std::fs::read_dir(all)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| root(path).exists())
        .collect();
    folders.sort();
    folders
}

/// The file at the root of a crate's modules. The Python package keeps its Rust apart from its Python.
fn root(folder: &Path) -> PathBuf {
    let own = folder.join("rust/lib.rs");
    match own.exists() {
        true => own,
        false => folder.join("src/lib.rs"),
    }
}

/// Every module of a crate that has a file of its own, without what is compiled for tests alone.
pub fn modules(folder: &Path) -> BTreeMap<Module, (PathBuf, Vec<Item>)> {
    let mut modules = BTreeMap::new();
    read(&root(folder), Vec::new(), &mut modules);
    modules
}

fn read(file: &Path, module: Module, into: &mut BTreeMap<Module, (PathBuf, Vec<Item>)>) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let items: Vec<Item> = parsed.items.into_iter().filter(|i| !for_tests(i)).collect();
    let plain = file
        .file_name()
        .is_some_and(|n| n != "mod.rs" && n != "lib.rs");
    let folder = match plain {
        true => file.with_extension(""),
        false => file.parent().expect("a folder").to_owned(),
    };
    for item in &items {
        let Item::Mod(child) = item else { continue };
        if child.content.is_some() {
            continue;
        }
        let name = child.ident.to_string();
        let named = folder.join(format!("{name}.rs"));
        let path = given_path(&child.attrs)
            .map(|given| file.parent().expect("a folder").join(given))
            .unwrap_or(match named.exists() {
                true => named,
                false => folder.join(&name).join("mod.rs"),
            });
        let mut below = module.clone();
        below.push(name);
        read(&path, below, into);
    }
    into.insert(module, (file.to_owned(), items));
}

fn for_tests(item: &Item) -> bool {
    let attributes = match item {
        Item::Mod(x) => &x.attrs,
        Item::Fn(x) => &x.attrs,
        Item::Use(x) => &x.attrs,
        Item::Const(x) => &x.attrs,
        Item::Impl(x) => &x.attrs,
        _ => return false,
    };
    attributes.iter().any(|attribute| {
        let is_cfg = attribute.path().is_ident("cfg");
        is_cfg && matches!(&attribute.meta, Meta::List(list) if list.tokens.to_string() == "test")
    })
}

/// The file of `#[path = "..."]`.
fn given_path(attributes: &[Attribute]) -> Option<String> {
    attributes
        .iter()
        .find_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
                syn::Expr::Lit(literal) => match &literal.lit {
                    syn::Lit::Str(text) => Some(text.value()),
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        })
}
