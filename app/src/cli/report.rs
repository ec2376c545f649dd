//! Counts and figures of a solution as JSON.

use lumenscope_core::{
    irradiance_volume::{
        IrradianceVolume, harmonics::Coefficients, pockets::POCKET_LEVEL, trust::SampleState,
    },
    radiosity::RadiositySolution,
    scene::world::World,
};
use serde_json::{Value, json};

/// Elements, sweeps, energy and bytes of a radiosity solution.
pub fn radiosity(solution: &RadiositySolution, world: &World) -> Value {
    json!({
        "elements": solution.elements().len(),
        "gather_rays": solution.settings().gather_rays,
        "convergence": solution.convergence(),
        "energy_lm": solution.energy(world),
        "bytes": solution.bytes(),
    })
}

/// Samples, bins and bytes of a volume.
pub fn volume(volume: &IrradianceVolume) -> Value {
    let samples = volume.samples();
    json!({
        "samples": samples.len(),
        "first_level_samples": samples.iter().filter(|s| s.level == 1).count(),
        "pocket_samples": samples.iter().filter(|s| s.level == POCKET_LEVEL).count(),
        "valid_samples": samples.iter().filter(|s| s.valid).count(),
        "bins": volume.bins().len(),
        "table_bytes_one_part": volume.table_bytes(),
        "harmonics_bytes_one_part": size_of::<Coefficients>() * samples.len(),
        "basis": volume.settings().basis,
        "moments": volume.orders(),
        "guard": volume.settings().guard,
        "samples_by_state": SampleState::ALL
            .map(|state| (state.name(), samples.iter().filter(|s| s.state == state).count()))
            .into_iter()
            .collect::<std::collections::BTreeMap<_, _>>(),
        "bytes": volume.bytes(),
    })
}
