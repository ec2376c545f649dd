//! Tests of irradiance volume.
