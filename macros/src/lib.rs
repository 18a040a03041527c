//! A thin door to the generator.
