//! Figures and self-contained pages from plain structs.
