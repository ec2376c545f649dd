//! Irradiance in 16 bits a channel: an unsigned float with 6 exponent and 10 mantissa bits.
//!
//! Covers 2⁻³⁰ to 2³³ lx, starlight to the surface of a lamp, with a relative error of at most 2⁻¹¹
//! (4.9e-4). Not a shared exponent in 32 bits (rgb9e5): its half step of 0.2 % would break the promise
//! that constant radiance L reads πL to 1e-3. Not IEEE half: its sign bit is wasted and 65,504 lx is
//! less than daylight. A texel is a shift away from the bits of an `f32`, which is what makes queries fast.

use glam::Vec3;
use wide::{f32x8, u32x8};

/// Three encoded channels, and a fourth that is zero so that a texel is eight bytes.
pub type Texel = [u16; 4];

/// Decoding is `f32::from_bits(u32::from(code) << 13) * SCALE`; the exponent bias of a code is 31.
pub const SCALE: f32 = f32::from_bits((127 + 96) << 23);

const INVERSE_SCALE: f32 = f32::from_bits((127 - 96) << 23);
const SMALLEST: f32 = f32::from_bits((127 - 30) << 23);
const LARGEST: f32 = f32::from_bits(((127 + 32) << 23) | (0x3FF << 13));

/// Code of a value; less than 2⁻³⁰ and NaN become 0, more than the largest becomes the largest.
#[inline(always)]
pub fn encode(value: f32) -> u16 {
    // Comparisons that are one instruction each, so that loops over values become vectors.
    let v = if value > 0.0 { value } else { 0.0 };
    let v = if v < LARGEST { v } else { LARGEST };
    let bits = (v * INVERSE_SCALE).to_bits();
    let rounded = (bits + 0x0FFF + ((bits >> 13) & 1)) >> 13;
    if v < SMALLEST { 0 } else { rounded as u16 }
}

/// [`encode`] of eight values of each channel.
#[inline(always)]
pub(super) fn encode_eight(rgb: [f32x8; 3]) -> [Texel; 8] {
    let by = u32x8::splat;
    let [r, g, b] = rgb.map(|value| {
        let v = value.simd_gt(f32x8::ZERO).select(value, f32x8::ZERO);
        let v = v.simd_lt(f32x8::splat(LARGEST)).select(v, f32x8::splat(LARGEST));
        let bits: u32x8 = bytemuck::cast(v * f32x8::splat(INVERSE_SCALE));
        let rounded = (bits + by(0x0FFF) + ((bits >> by(13)) & by(1))) >> by(13);
        let held: u32x8 = bytemuck::cast(v.simd_ge(f32x8::splat(SMALLEST)));
        rounded & held
    });
    let (low, high) = ((r | g << by(16)).to_array(), b.to_array());
    std::array::from_fn(|i| bytemuck::cast([low[i], high[i]]))
}

/// Value of a code.
#[inline]
pub fn decode(code: u16) -> f32 {
    f32::from_bits(u32::from(code) << 13) * SCALE
}

/// Red and blue of four texels, and their green and nothing, over [`SCALE`]: a shift and a mask for all lanes.
#[inline(always)]
pub(super) fn unscaled(texels: [Texel; 4]) -> [f32x8; 2] {
    let kept = u32x8::splat(0x1FFF_E000);
    let texels: u32x8 = bytemuck::cast(texels);
    // By vectors: a shift by one number for all takes it from memory.
    [texels << u32x8::splat(13), texels >> u32x8::splat(3)].map(|lanes| bytemuck::cast(lanes & kept))
}

/// Texel of three channels.
#[inline]
pub fn encode_rgb(rgb: Vec3) -> Texel {
    [encode(rgb.x), encode(rgb.y), encode(rgb.z), 0]
}

/// Three channels of a texel.
#[inline]
pub fn decode_rgb(texel: Texel) -> Vec3 {
    Vec3::new(decode(texel[0]), decode(texel[1]), decode(texel[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back_and_values_err_by_half_a_step() {
        for code in 1024..=u16::MAX {
            assert_eq!(encode(decode(code)), code);
        }
        for i in 0..100_000 {
            let v = 1e-8_f32 * 1.000_3_f32.powi(i);
            if v > 1e9 {
                break;
            }
            // Half a unit of the tenth mantissa bit.
            assert!((decode(encode(v)) - v).abs() <= v * 4.9e-4, "{v}");
        }
    }

    #[test]
    fn eight_at_once_are_each_alone() {
        let odd = [f32::NAN, f32::INFINITY, -1.0, 0.0, 1e-12, SMALLEST, LARGEST, f32::MAX];
        let values = (0..20_000).map(|i| 1e-10 * 1.002_f32.powi(i)).chain(odd);
        let values: Vec<f32> = values.collect();
        for eight in values.chunks_exact(8) {
            let turned = |by: usize| std::array::from_fn(|i| eight[(i + by) % 8]);
            let rgb: [[f32; 8]; 3] = [turned(0), turned(1), turned(2)];
            for (i, texel) in encode_eight(rgb.map(f32x8::new)).into_iter().enumerate() {
                assert_eq!(texel, [encode(rgb[0][i]), encode(rgb[1][i]), encode(rgb[2][i]), 0], "{eight:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_held_is_clamped() {
        assert_eq!(encode(f32::NAN), 0);
        assert_eq!(encode(-1.0), 0);
        assert_eq!(encode(0.0), 0);
        assert_eq!(encode(1e-12), 0);
        assert_eq!(encode(f32::INFINITY), u16::MAX);
        assert!(decode(u16::MAX) > 8e9);
    }
}
