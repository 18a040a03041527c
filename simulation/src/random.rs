//! Random numbers that depend on a seed alone: of draws among outcomes, of samples and of noise.

/// The next number of Steele, Lea and Flood's generator SplitMix64.
pub fn next_random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut word = *state;
    word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// A number of at most `most` (inclusive), from 0 on, each as probable as the others up to 2^-64 of them.
pub fn up_to(most: usize, state: &mut u64) -> usize {
    (next_random(state) % (most as u64 + 1)) as usize
}
