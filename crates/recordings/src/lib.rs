//! Tables of recordings and features, and their files: Parquet and MCAP.
