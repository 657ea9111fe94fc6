//! Instruments about methods: how often root finders are wrong, how long they take, and where each
//! way to a first hit begins to fail. None of it takes part in rendering; some of it is wrong on purpose.

#![allow(
    missing_docs,
    reason = "an instrument's parts, of which nothing is promised"
)]

pub mod failures;
pub mod finders;
