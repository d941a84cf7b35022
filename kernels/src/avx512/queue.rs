//! Which rays want a node, a leaf, a door (`levels.rs`) or a new ray, and prefetches of what they will read: sixteen
//! rays at a time, without branches.

use super::N;
use super::simd::{lanes_below, load16_u32, store8_u64, store16_u32};
use crate::bvh::{Block, Bvh, NOTHING, Node};
use crate::levels::DOOR;
use std::arch::x86_64::*;

/// Places of slots, and room for a whole vector to be written behind the last.
pub(super) struct List {
    len: usize,
    ids: [u32; N + 16],
}

impl List {
    const fn new() -> Self {
        Self {
            len: 0,
            ids: [0; N + 16],
        }
    }

    pub(super) fn fill_with_all(&mut self) {
        self.ids = std::array::from_fn(|i| i as u32);
        self.len = N;
    }

    #[inline]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline]
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids[..self.len.min(N)]
    }

    #[inline]
    pub(super) fn push(&mut self, id: u32) {
        self.ids[self.len] = id;
        self.len += 1;
    }

    /// Appends the lanes of `ids` that `which` names.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    fn append(&mut self, which: __mmask16, ids: __m512i) {
        if let Some(to) = self.ids[self.len..].first_chunk_mut() {
            store16_u32(to, _mm512_maskz_compress_epi32(which, ids));
        }
        self.len += which.count_ones() as usize;
    }
}

/// What a turn is about.
#[derive(Clone, Copy)]
pub(super) enum What {
    Nodes,
    Leaves,
    Doors,
}

/// Rays by what they want. A ray is in one list.
pub(super) struct Queues {
    pub(super) nodes: List,
    pub(super) leaves: List,
    /// Only in worlds of two levels.
    pub(super) doors: List,
    pub(super) done: List,
}

impl Queues {
    pub(super) const fn new() -> Self {
        Self {
            nodes: List::new(),
            leaves: List::new(),
            doors: List::new(),
            done: List::new(),
        }
    }

    /// Empties the list of those that are done into `take`.
    #[inline]
    pub(super) fn for_each_done(&mut self, mut take: impl FnMut(u32, &mut List)) {
        for i in 0..std::mem::take(&mut self.done.len) {
            take(self.done.ids[i], &mut self.nodes);
        }
    }

    /// Puts the slots of a list, by place in it, where their `next` references say, and asks for
    /// what those refer to. The list is written over behind where it is read.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn sort(&mut self, bvh: Bvh, what: What, next: &[u32; N]) {
        self.sort_with::<false>(bvh, what, next, |_| {});
    }

    /// The same where there may be doors, for which `fetch` asks.
    #[inline]
    #[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
    pub(super) fn sort_with<const DOORS: bool>(
        &mut self,
        bvh: Bvh,
        what: What,
        next: &[u32; N],
        fetch: impl Fn(u32),
    ) {
        let list = match what {
            What::Nodes => &mut self.nodes,
            What::Leaves => &mut self.leaves,
            What::Doors => &mut self.doors,
        };
        let len = std::mem::take(&mut list.len).min(N);
        for (first, next) in (0..len).step_by(16).zip(next.as_chunks().0) {
            let list = match what {
                What::Nodes => &self.nodes,
                What::Leaves => &self.leaves,
                What::Doors => &self.doors,
            };
            let Some(ids) = list.ids[first..].first_chunk() else {
                break;
            };
            let references = next;
            let (ids, next) = (load16_u32(ids), load16_u32(next));
            let left = len - first;
            let used = lanes_below(left);
            let high = _mm512_movepi32_mask(next);
            let end = _mm512_cmpeq_epi32_mask(next, _mm512_set1_epi32(NOTHING as i32));
            let mut doors = 0;
            if DOORS {
                doors = _mm512_test_epi32_mask(next, _mm512_set1_epi32(DOOR as i32));
                doors &= used & high & !end;
                self.doors.append(doors, ids);
            }
            self.nodes.append(used & !high, ids);
            self.leaves.append(used & high & !end & !doors, ids);
            self.done.append(used & end, ids);
            // Lanes that are not used ask for the root: fewer instructions than leaving them out.
            let none = end | !used | doors;
            while DOORS && doors != 0 {
                fetch(references[doors.trailing_zeros() as usize % 16]);
                doors &= doors - 1;
            }
            let half = _mm512_castsi512_si256(next);
            fetch_all(&locate(bvh, half, high as u8, none as u8));
            if left > 8 {
                let half = _mm512_extracti32x8_epi32::<1>(next);
                let (high, none) = (high >> 8, none >> 8);
                fetch_all(&locate(bvh, half, high as u8, none as u8));
            }
        }
    }
}

/// Where eight references' nodes or leaves lie; the root for those of `none`.
#[inline]
#[target_feature(enable = "avx512vl,avx512dq,avx512bw")]
fn locate(bvh: Bvh, next: __m256i, leaf: u8, none: u8) -> [u64; 8] {
    const { assert!(size_of::<Node>() == 1 << 8 && size_of::<Block>() == (1 << 7) + (1 << 5)) };
    let index = _mm256_and_si256(next, _mm256_set1_epi32(i32::MAX));
    let index = _mm512_maskz_cvtepu32_epi64(!none, index);
    let nodes = _mm512_set1_epi64(bvh.nodes.as_ptr().addr() as i64);
    let blocks = _mm512_set1_epi64(bvh.blocks.as_ptr().addr() as i64);
    let node = _mm512_add_epi64(nodes, _mm512_slli_epi64::<8>(index));
    let block = _mm512_add_epi64(_mm512_slli_epi64::<7>(index), _mm512_slli_epi64::<5>(index));
    let block = _mm512_add_epi64(blocks, block);
    let mut addresses = [0; 8];
    store8_u64(
        &mut addresses,
        _mm512_mask_mov_epi64(node, leaf & !none, block),
    );
    addresses
}

/// Asks for four cache lines from each address on, which may be any: all of a node, and all of a
/// block wherever it starts. Into the second cache, which measured best: the first has few places for
/// lines under way, and what is asked for in one burst would push out what the next sweep reads.
#[inline]
fn fetch_all(addresses: &[u64; 8]) {
    for &address in addresses {
        let address = address as usize as *const u8;
        for line in 0..4 {
            // SAFETY: a prefetch reads nothing as far as the program can tell; a bad address is ignored.
            unsafe { _mm_prefetch::<_MM_HINT_T1>(address.wrapping_add(64 * line).cast()) };
        }
    }
}
