//! A volume in a file: settings, grid, samples and both tables; little-endian, with a checksum.
//!
//! What rays met is not kept: it names elements of one radiosity solution, which the file does not hold.

use super::{
    IrradianceVolume, Sample, Tables, VolumeError, VolumeSettings,
    codec::Texel,
    directions::Directions,
    grid::{BilevelGrid, NONE},
    moments::{MomentTable, beside_irradiance},
    trust::SampleState,
};
use crate::math::sphere_map::DirectionBins;
use glam::{UVec3, Vec3};
use std::{path::Path, sync::Arc};

const MAGIC: &[u8; 8] = b"LUMVOL03";
/// Files from before there were pockets.
const WITHOUT_POCKETS: &[u8; 8] = b"LUMVOL02";

impl IrradianceVolume {
    /// Writes the volume.
    ///
    /// # Errors
    /// [`VolumeError::File`] when it cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), VolumeError> {
        let settings = serde_json::to_vec(&self.settings)
            .map_err(|e| VolumeError::Format { path: path.into(), reason: e.to_string() })?;
        let (low, high) = self.grid.bounds();
        let mut body = Vec::with_capacity(2 * self.table_bytes() + 1_000_000);
        body.extend((settings.len() as u32).to_le_bytes());
        body.extend(settings);
        for v in [low, high] {
            v.to_array().iter().for_each(|f| body.extend(f.to_le_bytes()));
        }
        self.grid.size().to_array().iter().for_each(|n| body.extend(n.to_le_bytes()));
        body.extend(self.grid.second().iter().map(|&s| u8::from(s != NONE)));
        body.extend((self.grid.pockets().len() as u32).to_le_bytes());
        self.grid.pockets().for_each(|eighth| body.extend(eighth.to_le_bytes()));
        for sample in self.samples() {
            body.extend(sample.back_face_fraction.to_le_bytes());
            body.push(sample.state as u8);
            sample.position.to_array().iter().for_each(|f| body.extend(f.to_le_bytes()));
        }
        let moments = self.tables.moments.iter().flat_map(|m| [&m.direct, &m.indirect]);
        for table in [&self.tables.direct, &self.tables.indirect].into_iter().chain(moments) {
            for texel in table.iter() {
                texel[..3].iter().for_each(|code| body.extend(code.to_le_bytes()));
            }
        }
        let mut bytes = MAGIC.to_vec();
        bytes.extend(checksum(&body).to_le_bytes());
        bytes.extend(body);
        std::fs::write(path, bytes).map_err(|cause| VolumeError::File { path: path.into(), cause })
    }

    /// Reads a volume. It answers queries and shows its samples; it cannot be relit.
    ///
    /// # Errors
    /// [`VolumeError::File`] when it cannot be read, [`VolumeError::Format`] when it is something else,
    /// cut short or damaged.
    pub fn load(path: &Path) -> Result<Self, VolumeError> {
        let bytes = std::fs::read(path).map_err(|cause| VolumeError::File { path: path.into(), cause })?;
        parse(&bytes).map_err(|reason| VolumeError::Format { path: path.into(), reason })
    }
}

fn parse(bytes: &[u8]) -> Result<IrradianceVolume, String> {
    let mut rest = bytes;
    let magic = take(&mut rest, MAGIC.len()).unwrap_or_default();
    if magic != MAGIC && magic != WITHOUT_POCKETS {
        return Err(format!("it does not begin with {}", String::from_utf8_lossy(MAGIC)));
    }
    let wanted = u64::from_le_bytes(array(&mut rest)?);
    if checksum(rest) != wanted {
        return Err("its checksum does not match: it is cut short or damaged".into());
    }
    let length = u32::from_le_bytes(array(&mut rest)?) as usize;
    let settings: VolumeSettings =
        serde_json::from_slice(take(&mut rest, length)?).map_err(|e| format!("settings: {e}"))?;
    settings.check().map_err(|e| e.to_string())?;
    let mut corner = || -> Result<Vec3, String> {
        Ok(Vec3::new(f32_of(&mut rest)?, f32_of(&mut rest)?, f32_of(&mut rest)?))
    };
    let (low, high) = (corner()?, corner()?);
    let mut axis = || -> Result<u32, String> { Ok(u32::from_le_bytes(array(&mut rest)?)) };
    let size = UVec3::new(axis()?, axis()?, axis()?);
    let extent = high - low;
    if size.min_element() == 0
        || size.max_element() > 200
        || !(extent.is_finite() && extent.min_element() > 0.0)
    {
        return Err(format!("a grid of {size} cells from {low} m to {high} m"));
    }
    settings.check_cells(size).map_err(|e| e.to_string())?;
    // Before anything is made room for, the file holds what it promises.
    let tables = 1 + beside_irradiance(&settings.moments).len();
    let a_sample = 17 + 12 * DirectionBins::new(settings.bins_n).len() * tables;
    let enough = |samples: usize, rest: &[u8]| {
        let needed = samples as u64 * a_sample as u64;
        if rest.len() as u64 >= needed {
            Ok(())
        } else {
            Err(format!("{samples} samples need {needed} bytes, it has {}", rest.len()))
        }
    };
    enough((size + UVec3::ONE).element_product() as usize, rest)?;
    let flags = take(&mut rest, size.element_product() as usize)?.iter().map(|&f| f != 0);
    let flags: Vec<bool> = flags.collect();
    let mut grid = BilevelGrid::new(low, high, size + UVec3::ONE, settings.second_level, &flags);
    enough(grid.places().len(), rest)?;
    let pockets = match magic == MAGIC {
        true => u32::from_le_bytes(array(&mut rest)?) as usize,
        false => 0,
    };
    enough(grid.places().len() + pockets, rest)?;
    let pockets = take(&mut rest, 4 * pockets)?.chunks_exact(4);
    let pockets: Vec<u32> = pockets.map(|e| u32::from_le_bytes([e[0], e[1], e[2], e[3]])).collect();
    let in_order = pockets.windows(2).all(|pair| pair[0] < pair[1]);
    if !in_order || pockets.last().is_some_and(|&eighth| eighth as usize / 8 >= grid.cells().len()) {
        return Err("pockets out of order or beyond the grid".into());
    }
    grid.add_pockets(&pockets);
    let mut samples = Vec::with_capacity(grid.places().len());
    for place in grid.places() {
        let back_face_fraction = f32_of(&mut rest)?;
        let [state] = array(&mut rest)?;
        let state = *SampleState::ALL.get(usize::from(state)).ok_or(format!("a sample in state {state}"))?;
        let position = Vec3::new(f32_of(&mut rest)?, f32_of(&mut rest)?, f32_of(&mut rest)?);
        if !(position.is_finite() && back_face_fraction.is_finite()) {
            return Err(format!("a sample at {position} m"));
        }
        let valid = state != SampleState::Masked;
        samples.push(Sample { position, level: place.level, back_face_fraction, valid, state });
    }
    grid.set_valid(&samples.iter().map(|s| s.valid).collect::<Vec<_>>());
    let bins = DirectionBins::new(settings.bins_n);
    let mut table = || -> Result<Vec<Texel>, String> {
        let raw = take(&mut rest, 6 * samples.len() * bins.len())?;
        let code = |t: &[u8], i: usize| u16::from_le_bytes([t[2 * i], t[2 * i + 1]]);
        Ok(raw.chunks_exact(6).map(|t| [code(t, 0), code(t, 1), code(t, 2), 0]).collect())
    };
    let mut tables = Tables::new(bins, Arc::new(table()?), Arc::new(table()?));
    for order in beside_irradiance(&settings.moments) {
        let (direct, indirect) = (Arc::new(table()?), Arc::new(table()?));
        tables.moments.push(MomentTable { order, direct, indirect });
    }
    if !rest.is_empty() {
        return Err(format!("{} bytes too many", rest.len()));
    }
    let ages = Arc::new(vec![0; samples.len()]);
    Ok(IrradianceVolume {
        settings,
        grid: Arc::new(grid),
        samples: Arc::new(samples),
        directions: Arc::new(Directions::new(bins)),
        transport: None,
        arrivals: Vec::new(),
        kernels: Arc::default(),
        fills: Arc::default(),
        guard: None,
        ages,
        tables,
    })
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Result<&'a [u8], String> {
    let (taken, left) =
        rest.split_at_checked(count).ok_or_else(|| format!("it ends {} bytes early", count - rest.len()))?;
    *rest = left;
    Ok(taken)
}

fn array<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N], String> {
    take(rest, N)?.try_into().map_err(|_| "it is cut short".to_string())
}

fn f32_of(rest: &mut &[u8]) -> Result<f32, String> {
    Ok(f32::from_le_bytes(array(rest)?))
}

/// FNV-1a over words of eight bytes: against damage, not against intent.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.chunks(8).fold(0xCBF2_9CE4_8422_2325 ^ bytes.len() as u64, |hash, chunk| {
        let mut word = [0u8; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x0000_0100_0000_01B3).rotate_left(29)
    })
}
