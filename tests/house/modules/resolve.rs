//! Resolves paths to the modules that declare their items.

use std::collections::BTreeSet;

use super::tree::{Names, Tree, with_name};

/// What a path leads to.
enum Target {
    Module(Names),
    /// An item of this module.
    Item(Names),
}

/// Paths under resolution, so that modules that import each other's names end it.
type Open = BTreeSet<(Names, Names)>;

impl Tree {
    /// The modules whose items a module uses.
    pub(super) fn used_modules(&self, from: &[String]) -> BTreeSet<Names> {
        let module = &self.0[from];
        let mut used = BTreeSet::new();
        for import in &module.imports {
            if import.name == "*" {
                used.extend(self.used_by_glob(from, &import.path));
            } else if !import.is_public || module.words.contains(&import.name) {
                // A re-export alone is no use.
                used.extend(self.declaring_module(from, &import.path));
            }
        }
        used.extend(
            module
                .paths
                .iter()
                .filter_map(|path| self.declaring_module(from, path)),
        );
        used.remove(from);
        used
    }

    fn used_by_glob(&self, from: &[String], path: &[String]) -> BTreeSet<Names> {
        let parent = &path[..path.len() - 1];
        let Some(Target::Module(globbed)) = self.resolve(from, parent, &mut Open::new()) else {
            return BTreeSet::new();
        };
        let words = self.0[from].words.iter();
        words
            .filter_map(|word| self.declaring_module(&globbed, std::slice::from_ref(word)))
            .collect()
    }

    fn declaring_module(&self, from: &[String], path: &[String]) -> Option<Names> {
        match self.resolve(from, path, &mut Open::new())? {
            Target::Item(module) => Some(module),
            Target::Module(_) => None,
        }
    }

    fn resolve(&self, from: &[String], path: &[String], open: &mut Open) -> Option<Target> {
        let mut module = from.to_vec();
        for (index, segment) in path.iter().enumerate() {
            let is_last = index + 1 == path.len();
            let here = self.0.get(&module)?;
            match segment.as_str() {
                "crate" => module.clear(),
                "self" => {}
                "super" => drop(module.pop()?),
                name if here.types.contains(name) => return Some(Target::Item(module)),
                name if is_last && here.values.contains(name) => return Some(Target::Item(module)),
                name if here.children.contains(name) => module.push(name.to_owned()),
                name => match self.resolve_import(&module, name, open)? {
                    Target::Module(next) => module = next,
                    item @ Target::Item(_) => return Some(item),
                },
            }
        }
        Some(Target::Module(module))
    }

    /// Resolves a name that a module imports.
    fn resolve_import(&self, module: &[String], name: &str, open: &mut Open) -> Option<Target> {
        if !open.insert((module.to_vec(), vec![name.to_owned()])) {
            return None;
        }
        let imports = &self.0[module].imports;
        if let Some(import) = imports.iter().find(|import| import.name == name) {
            let is_external = import.path.len() == 1 && import.path[0] == name;
            return (!is_external).then(|| self.resolve(module, &import.path, open))?;
        }
        let globs = imports.iter().filter(|import| import.name == "*");
        for glob in globs {
            let parent = &glob.path[..glob.path.len() - 1];
            if let Some(Target::Module(next)) = self.resolve(module, parent, open)
                && let Some(found) = self.resolve(&next, &[name.to_owned()], open)
            {
                return Some(found);
            }
        }
        None
    }
}

/// The two neighbors at the level where the paths of two modules part: children of one module, or a child and the
/// module itself.
pub(super) struct Arrow {
    /// The module that contains both.
    pub(super) level: Names,
    pub(super) user: Names,
    pub(super) used: Names,
}

impl Arrow {
    pub(super) fn new(user: &[String], used: &[String]) -> Self {
        let common = user.iter().zip(used).take_while(|(a, b)| a == b).count();
        let level = user[..common].to_vec();
        Self {
            user: neighbor(&level, user.get(common)),
            used: neighbor(&level, used.get(common)),
            level,
        }
    }
}

fn neighbor(level: &[String], name: Option<&String>) -> Names {
    name.map_or_else(|| level.to_vec(), |name| with_name(level, name))
}
