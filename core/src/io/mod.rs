//! Files written and read besides scenes: EXR layers, sessions, caches.
