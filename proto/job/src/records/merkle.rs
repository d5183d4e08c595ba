//! A Merkle tree: one digest for a sequence whose parts can be compared separately.

use imaging::digest::hex;
use sha2::{Digest, Sha256};

/// A Merkle tree over a stream of leaves as in RFC 6962 (2013), section 2.1: leaves and nodes are hashed separately, with
/// a leading 0 or 1, and the last node of an odd level moves up unchanged. The state is one digest for each bit of the
/// number of leaves.
#[derive(Debug, Clone, Default)]
pub struct MerkleTree {
    /// Complete subtrees, the largest first.
    subtrees: Vec<Subtree>,
}

#[derive(Debug, Clone)]
struct Subtree {
    height: u32,
    root: [u8; 32],
}

impl MerkleTree {
    /// Adds a leaf.
    pub fn push(&mut self, leaf: impl AsRef<[u8]>) {
        let mut added = Subtree {
            height: 0,
            root: Sha256::new()
                .chain_update([0])
                .chain_update(leaf)
                .finalize()
                .into(),
        };
        while let Some(left) = self.subtrees.pop_if(|left| left.height == added.height) {
            added = Subtree {
                height: left.height + 1,
                root: node(&left.root, &added.root),
            };
        }
        self.subtrees.push(added);
    }

    /// The root of the leaves so far, lower-case hex; without leaves the SHA-256 of the empty string.
    #[must_use]
    pub fn root(&self) -> String {
        let roots = self.subtrees.iter().rev().map(|subtree| subtree.root);
        let root = roots.reduce(|right, left| node(&left, &right));
        root.map_or_else(|| hex(&Sha256::digest([])), |root| hex(&root))
    }
}

fn node(left: &[u8; 32], right: &[u8; 32]) -> [u8; 32] {
    Sha256::new()
        .chain_update([1])
        .chain_update(left)
        .chain_update(right)
        .finalize()
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: the left part has the largest power of two below the number of leaves.
    fn by_definition(leaves: &[String]) -> [u8; 32] {
        match leaves {
            [] => Sha256::digest([]).into(),
            [leaf] => Sha256::new()
                .chain_update([0])
                .chain_update(leaf)
                .finalize()
                .into(),
            _ => {
                let (left, right) = leaves.split_at(leaves.len().next_power_of_two() / 2);
                node(&by_definition(left), &by_definition(right))
            }
        }
    }

    #[test]
    fn the_root_is_that_of_the_definition_for_every_number_of_leaves() {
        let (mut tree, mut leaves) = (MerkleTree::default(), Vec::new());
        for number in 0..70 {
            assert_eq!(tree.root(), hex(&by_definition(&leaves)), "{number} leaves");
            let leaf = format!("leaf {number}");
            tree.push(&leaf);
            leaves.push(leaf);
        }
    }

    #[test]
    fn order_and_every_leaf_count() {
        let root = |leaves: &[&str]| {
            let mut tree = MerkleTree::default();
            leaves.iter().for_each(|leaf| tree.push(leaf));
            tree.root()
        };
        assert_ne!(root(&["a", "b"]), root(&["b", "a"]));
        assert_ne!(root(&["a", "b", "b"]), root(&["a", "b"]));
        assert_ne!(root(&["a", "b", "c"]), root(&["a", "b", "d"]));
    }
}
