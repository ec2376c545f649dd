//! How far pictures and irradiances are from each other.
