//! Random numbers from (seed, item), never from time or thread, so every result is repeatable.

use glam::Vec2;

/// PCG-RXS-M-XS 32-bit hash: one well-mixed word from another. Has a twin in `shaders/shared/random.wgsl`.
pub fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Hash of two words.
pub fn hash2(a: u32, b: u32) -> u32 {
    hash(a ^ hash(b))
}

/// A seed as one word for [`hash2`] and [`r2_point`]: its halves, exclusive-or. Seeds below 2³² are themselves.
pub fn fold(seed: u64) -> u32 {
    seed as u32 ^ (seed >> 32) as u32
}

/// Uniform number in [0, 1) from the upper 24 bits of a word.
pub fn unit_f32(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Point `index` of the two-dimensional R₂ additive recurrence, shifted by a hash of `scramble`.
///
/// Integer arithmetic throughout, so the CPU and the GPU draw the same points. Stratified for any
/// prefix length, which a fixed grid of strata is not.
pub fn r2_point(index: u32, scramble: u32) -> Vec2 {
    let x = hash(scramble).wrapping_add(index.wrapping_mul(0xC13F_A9A9));
    let y = hash(scramble ^ 0x9E37_79B9).wrapping_add(index.wrapping_mul(0x91E1_0DA5));
    Vec2::new(unit_f32(x), unit_f32(y))
}

/// A small stream of numbers that belongs to one (seed, item).
#[derive(Clone, Copy, Debug)]
pub struct Rng {
    state: u64,
    increment: u64,
}

impl Rng {
    /// Stream of one item under one seed (PCG32, O'Neill 2014).
    pub fn new(seed: u64, item: u64) -> Self {
        let mut rng = Self { state: 0, increment: (item << 1) | 1 };
        rng.next_u32();
        rng.state = rng.state.wrapping_add(seed ^ item.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        rng.next_u32();
        rng.next_u32();
        rng
    }

    /// Next 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(self.increment);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Next number in [0, 1).
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }

    /// Next point in [0, 1)².
    pub fn next_vec2(&mut self) -> Vec2 {
        Vec2::new(self.next_f32(), self.next_f32())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_bit_of_a_seed_is_lost_and_small_seeds_are_themselves() {
        assert!([0, 1, 7, u32::MAX].iter().all(|&seed| fold(u64::from(seed)) == seed));
        assert!((0..64).all(|bit| fold(1 << bit) != fold(0)));
    }
}
