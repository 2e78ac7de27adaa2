//! Files of a crate that import each other, straight or in a circle.

use crate::sources::{Module, crates, modules};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use syn::visit::Visit;
use syn::{Item, ItemUse, Path, UseTree, Visibility};

/// Files that still stand in circles, by crate. The numbers fall and never rise; a crate that is not listed has none.
const STILL: [(&str, usize); 5] = [
    ("calibrate", 11),
    ("features", 7),
    ("input", 15),
    ("mechanism", 13),
    ("simulate", 10),
];

#[test]
fn no_more_files_import_each_other_in_a_circle() {
    let mut wrong = Vec::new();
    for folder in crates() {
        let house = House::read(modules(&folder));
        let circles = circles(&house.arrows());
        let name = folder.file_name().expect("a name").to_string_lossy();
        let still = STILL.iter().find(|(listed, _)| *listed == name);
        let still = still.map_or(0, |(_, files)| *files);
        let files = circles.iter().map(Vec::len).sum::<usize>();
        if files != still {
            let ties = circles.iter().flat_map(|circle| house.ties(circle));
            let ties: Vec<String> = ties.collect();
            wrong.push(format!(
                "{name}: {files} files in circles, where {} lists {still}\n  {}",
                file!(),
                ties.join("\n  ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_circle_is_found() {
    let arrows = BTreeMap::from([
        (vec!["a".to_owned()], BTreeSet::from([vec!["b".to_owned()]])),
        (vec!["b".to_owned()], BTreeSet::from([vec!["c".to_owned()]])),
        (vec!["c".to_owned()], BTreeSet::from([vec!["b".to_owned()]])),
    ]);
    assert_eq!(
        circles(&arrows),
        [[vec!["b".to_owned()], vec!["c".to_owned()]]]
    );
}

/// A crate: for each module the paths that it imports, and the names that it hands on.
struct House {
    imports: BTreeMap<Module, Vec<Module>>,
    handed_on: BTreeMap<Module, Vec<(String, Module)>>,
}

impl House {
    fn read(modules: BTreeMap<Module, (PathBuf, Vec<Item>)>) -> Self {
        let mut house = Self {
            imports: BTreeMap::new(),
            handed_on: BTreeMap::new(),
        };
        for (module, (_, items)) in modules {
            let mut paths = Paths::default();
            items.iter().for_each(|item| paths.visit_item(item));
            let absolute = |path: Vec<String>| absolute(&module, path);
            let imports = paths.used.into_iter().filter_map(absolute).collect();
            let handed_on = paths.handed_on.into_iter();
            let handed_on = handed_on.filter_map(|(name, path)| Some((name, absolute(path)?)));
            house.handed_on.insert(module.clone(), handed_on.collect());
            house.imports.insert(module, imports);
        }
        house
    }

    /// The module in which the last name of a path is defined, if it is one of this crate's.
    fn home(&self, path: &[String], depth: usize) -> Option<Module> {
        let mut at: Module = Vec::new();
        for (i, name) in path.iter().enumerate() {
            let mut below = at.clone();
            below.push(name.clone());
            if self.imports.contains_key(&below) {
                at = below;
                continue;
            }
            let handed_on = self.handed_on.get(&at)?;
            let rest = &path[i + 1..];
            let through = |target: &Module| {
                let whole: Vec<String> = target.iter().chain(rest).cloned().collect();
                self.home(&whole, depth + 1)
            };
            if depth > 8 {
                return None;
            }
            let by_name = handed_on.iter().find(|(as_name, _)| as_name == name);
            return match by_name {
                Some((_, target)) => through(target),
                None => Some(at),
            };
        }
        Some(at)
    }

    fn arrows(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let of = |(module, paths): (&Module, &Vec<Module>)| {
            let homes = paths.iter().filter_map(|path| self.home(path, 0));
            let others = homes.filter(|home| home != module);
            (module.clone(), others.collect())
        };
        self.imports.iter().map(of).collect()
    }

    /// What ties a circle: each import between two of its files.
    fn ties(&self, circle: &[Module]) -> Vec<String> {
        let mut ties = BTreeSet::new();
        for module in circle {
            for path in &self.imports[module] {
                let home = self.home(path, 0);
                if home
                    .as_ref()
                    .is_some_and(|h| h != module && circle.contains(h))
                {
                    ties.insert(format!("{} -> {}", module.join("::"), path.join("::")));
                }
            }
        }
        ties.into_iter().collect()
    }
}

/// A path from the crate's root, where it starts at `crate`, `self` or `super`.
fn absolute(module: &Module, path: Vec<String>) -> Option<Module> {
    let mut at = module.clone();
    let mut rest = path.as_slice();
    match rest.first()?.as_str() {
        "crate" => at.clear(),
        "self" => {}
        "super" => {
            at.pop();
        }
        _ => return None,
    }
    rest = &rest[1..];
    while rest.first().is_some_and(|name| name == "super") {
        at.pop();
        rest = &rest[1..];
    }
    at.extend(rest.iter().cloned());
    Some(at)
}

/// The paths of a file, as they are written.
#[derive(Default)]
struct Paths {
    used: Vec<Vec<String>>,
    handed_on: Vec<(String, Vec<String>)>,
    /// Child modules, whose names may begin a path.
    children: BTreeSet<String>,
    /// What a `use` has given a short name, with its path.
    short: BTreeMap<String, Vec<String>>,
}

impl<'a> Visit<'a> for Paths {
    fn visit_item_mod(&mut self, module: &'a syn::ItemMod) {
        self.children.insert(module.ident.to_string());
        syn::visit::visit_item_mod(self, module);
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        let mut leaves = Vec::new();
        walk(&item.tree, &mut Vec::new(), &mut leaves);
        for (name, mut path) in leaves {
            if path
                .first()
                .is_some_and(|first| self.children.contains(first))
            {
                path.insert(0, "self".to_owned());
            }
            match item.vis {
                Visibility::Inherited => {
                    self.short.insert(name, path.clone());
                    self.used.push(path);
                }
                _ => self.handed_on.push((name, path)),
            }
        }
    }

    fn visit_path(&mut self, path: &'a Path) {
        let mut names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if names.len() > 1 {
            match self.short.get(&names[0]) {
                Some(path) => drop(names.splice(..1, path.iter().cloned())),
                None if self.children.contains(&names[0]) => names.insert(0, "self".to_owned()),
                None => {}
            }
            self.used.push(names);
        }
        syn::visit::visit_path(self, path);
    }
}

/// The leaves of a `use`, each with the name under which it is known here.
fn walk(tree: &UseTree, at: &mut Vec<String>, leaves: &mut Vec<(String, Vec<String>)>) {
    match tree {
        UseTree::Path(path) => {
            at.push(path.ident.to_string());
            walk(&path.tree, at, leaves);
            at.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|item| walk(item, at, leaves)),
        UseTree::Glob(_) => leaves.push(("*".to_owned(), at.clone())),
        UseTree::Name(name) if name.ident == "self" => {
            leaves.push((at.last().cloned().unwrap_or_default(), at.clone()));
        }
        UseTree::Name(name) => leaf(name.ident.to_string(), name.ident.to_string(), at, leaves),
        UseTree::Rename(rename) => leaf(
            rename.rename.to_string(),
            rename.ident.to_string(),
            at,
            leaves,
        ),
    }
}

fn leaf(name: String, last: String, at: &[String], leaves: &mut Vec<(String, Vec<String>)>) {
    let mut path = at.to_vec();
    path.push(last);
    leaves.push((name, path));
}

/// Modules that reach each other, in groups of two and more.
fn circles(arrows: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<Vec<Module>> {
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = arrows
        .keys()
        .map(|from| (from, reach(from, arrows)))
        .collect();
    let mut found: Vec<Vec<Module>> = Vec::new();
    for from in arrows.keys() {
        let together = |to: &&Module| {
            reached[from].contains(*to) && reached.get(to).is_some_and(|back| back.contains(from))
        };
        let circle: Vec<Module> = arrows.keys().filter(together).cloned().collect();
        if circle.len() > 1 && !found.contains(&circle) {
            found.push(circle);
        }
    }
    found
}

fn reach<'a>(
    from: &'a Module,
    arrows: &'a BTreeMap<Module, BTreeSet<Module>>,
) -> BTreeSet<&'a Module> {
    let mut seen = BTreeSet::new();
    let mut next = vec![from];
    while let Some(module) = next.pop() {
        for to in arrows.get(module).into_iter().flatten() {
            if seen.insert(to) {
                next.push(to);
            }
        }
    }
    seen
}
