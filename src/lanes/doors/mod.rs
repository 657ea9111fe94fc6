//! Doors that only this crate can open: they go through its list of materials. They are of the same
//! kind as those of `etalon-doors`, which shows them beside its own.

pub mod material;
