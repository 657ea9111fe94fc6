//! Tables so small that they fit in a few registers, looked up without touching memory lane by
//! lane.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, f64x8, u32x16, u64x8};

/// Entries of a small table.
pub const SMALL: usize = 16;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::SMALL;
    use fearless_simd::{f32x8, f32x16, f64x8, prelude::*, u32x8, u32x16, u64x8};
    use std::arch::x86_64::{
        __m256, __m512, __m512d, _mm256_blendv_ps, _mm256_castsi256_ps, _mm256_permutevar8x32_ps,
        _mm256_slli_epi32, _mm512_permutex2var_pd, _mm512_permutexvar_ps,
    };

    fearless_simd::kernel!(
        #[inline(always)]
        pub fn single_avx512(token: Avx512, table: [f32; SMALL], index: [u32; 16]) -> [f32; 16] {
            let table: f32x16<_> = table.simd_into(token);
            let index: u32x16<_> = index.simd_into(token);
            let found: __m512 = _mm512_permutexvar_ps(index.into(), table.into());
            let found: f32x16<_> = found.simd_into(token);
            found.into()
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        pub fn double_avx512(token: Avx512, table: [f64; SMALL], index: [u64; 8]) -> [f64; 8] {
            let halves = table.as_chunks::<8>().0;
            let low: f64x8<_> = halves[0].simd_into(token);
            let high: f64x8<_> = halves[1].simd_into(token);
            let index: u64x8<_> = index.simd_into(token);
            let found: __m512d = _mm512_permutex2var_pd(low.into(), index.into(), high.into());
            let found: f64x8<_> = found.simd_into(token);
            found.into()
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        pub fn single_avx2(token: Avx2, table: [f32; SMALL], index: [u32; 16]) -> [f32; 16] {
            let halves = table.as_chunks::<8>().0;
            let low: f32x8<_> = halves[0].simd_into(token);
            let high: f32x8<_> = halves[1].simd_into(token);
            let mut out = [0.0; 16];
            for (out, index) in out
                .as_chunks_mut::<8>()
                .0
                .iter_mut()
                .zip(index.as_chunks::<8>().0)
            {
                let index: u32x8<_> = (*index).simd_into(token);
                // Bit 3 of the index becomes the sign, which the blend looks at.
                let above = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index.into()));
                let found: __m256 = _mm256_blendv_ps(
                    _mm256_permutevar8x32_ps(low.into(), index.into()),
                    _mm256_permutevar8x32_ps(high.into(), index.into()),
                    above,
                );
                let found: f32x8<_> = found.simd_into(token);
                *out = found.into();
            }
            out
        }
    );
}

/// `table[index % 16]` lane by lane, whatever the bits of the entries mean.
#[inline(always)]
pub fn single<S: Simd>(simd: S, table: u32x16<S>, index: u32x16<S>) -> u32x16<S> {
    let table: f32x16<S> = table.bitcast();
    let (table, index): ([f32; 16], [u32; 16]) = (table.into(), index.into());
    let found: f32x16<S> = match simd.level() {
        #[cfg(target_arch = "x86_64")]
        fearless_simd::Level::Avx512(token) => {
            x86::single_avx512(token, table, index).simd_into(simd)
        }
        #[cfg(target_arch = "x86_64")]
        fearless_simd::Level::Avx2(token) => x86::single_avx2(token, table, index).simd_into(simd),
        _ => {
            let mut out = [0.0; 16];
            for (out, i) in out.iter_mut().zip(index) {
                *out = table[i as usize % SMALL];
            }
            out.simd_into(simd)
        }
    };
    found.bitcast()
}

/// `table[index % 16]` lane by lane.
#[inline(always)]
pub fn double<S: Simd>(simd: S, table: &[f64; SMALL], index: u64x8<S>) -> f64x8<S> {
    let index: [u64; 8] = index.into();
    let found = match simd.level() {
        #[cfg(target_arch = "x86_64")]
        fearless_simd::Level::Avx512(token) => x86::double_avx512(token, *table, index),
        _ => {
            let mut out = [0.0; 8];
            for (out, i) in out.iter_mut().zip(index) {
                *out = table[i as usize % SMALL];
            }
            out
        }
    };
    found.simd_into(simd)
}
