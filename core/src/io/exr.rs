//! Linear layers in one OpenEXR file.
//!
//! One part whose channels are called `layer.R`, `layer.G`, `layer.B`, and plain `R`, `G`, `B` for
//! the layer called "" (the sum): what tev, Blender and Nuke show as layers. Not one part a layer:
//! fewer programs list those. Samples are `f32`, compressed without loss.

use super::{IoError, write_file};
use crate::math::image::LinearImage;
use exr::{
    image::{AnyChannel, AnyChannels, Encoding, FlatImage, FlatSamples, Image, Layer as ExrPart},
    meta::{
        MetaData,
        attribute::{AttributeValue, EnvironmentMap, Text},
        header::{ImageAttributes, LayerAttributes},
    },
    prelude::{ReadChannels, ReadLayers, WritableImage, read},
};
use glam::Vec3;
use std::{
    collections::BTreeMap,
    io::Cursor,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

/// Attribute that keeps the order of the layers, one name a line; channels are sorted by name.
const ORDER: &str = "lumenscopeLayers";

/// No lossless EXR compression gains more than this; a header that promises more is corrupt.
const LARGEST_COMPRESSION: u64 = 2000;

/// A part of a file: layers of one size with what there is to say about them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part<'a> {
    /// Its name; may be empty where there is only one.
    pub name: &'a str,
    /// Layers by name.
    pub layers: &'a [(&'a str, &'a LinearImage)],
    /// What it is, in a sentence, for its comments.
    pub note: &'a str,
    /// Other attributes by name.
    pub attributes: &'a [(&'a str, String)],
    /// Whether it is a latitude–longitude map, by OpenEXR's convention.
    pub is_environment: bool,
}

/// Writes layers of one size into one file, with a note in its comments.
///
/// # Errors
/// [`IoError::Write`] naming the file and the cause: no layers, empty ones, different sizes, a name
/// twice, or a place that cannot be written.
pub fn write_layers(path: &Path, layers: &[(&str, &LinearImage)], note: &str) -> Result<(), IoError> {
    write_parts(path, &[Part { layers, note, ..Part::default() }])
}

/// Writes parts into one file; programs that know no parts show the first.
///
/// # Errors
/// Those of [`write_layers`], for any part.
pub fn write_parts(path: &Path, parts: &[Part<'_>]) -> Result<(), IoError> {
    let made: Result<Vec<_>, _> = parts.iter().map(encoded).collect();
    let made = made.map_err(|cause| IoError::write(path, cause))?;
    let Some(first) = made.first() else { return Err(IoError::write(path, "no parts")) };
    let attributes = ImageAttributes::with_size(first.size);
    let mut bytes = Cursor::new(Vec::new());
    let parts: exr::prelude::SmallVec<[_; 2]> = made.into();
    Image::from_layers(attributes, parts)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|cause| IoError::write(path, cause))?;
    write_file(path, bytes.get_ref())
}

fn encoded(part: &Part<'_>) -> Result<ExrPart<AnyChannels<FlatSamples>>, String> {
    let Some((_, first)) = part.layers.first() else { return Err("no layers".into()) };
    let mut channels = exr::prelude::SmallVec::new();
    for (i, (name, image)) in part.layers.iter().enumerate() {
        if (image.width, image.height) != (first.width, first.height) || image.pixels.is_empty() {
            return Err(format!(
                "layer \"{name}\" has {}x{} pixels, the first one {}x{}",
                image.width, image.height, first.width, first.height
            ));
        }
        if part.layers[..i].iter().any(|(other, _)| other == name) {
            return Err(format!("two layers are called \"{name}\""));
        }
        for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let channel = if name.is_empty() { letter.to_owned() } else { format!("{name}.{letter}") };
            let Some(text) = Text::new_or_none(&channel) else {
                return Err(format!("\"{channel}\" cannot name a channel"));
            };
            let samples = FlatSamples::F32(image.pixels.iter().map(|p| p[c]).collect());
            channels.push(AnyChannel::new(text, samples));
        }
    }
    let mut attributes =
        LayerAttributes { comments: Text::new_or_none(part.note), ..LayerAttributes::default() };
    if !part.name.is_empty() {
        attributes.layer_name = Text::new_or_none(part.name);
    }
    attributes.software_name = Text::new_or_none("lumenscope");
    attributes.environment_map = part.is_environment.then_some(EnvironmentMap::LatitudeLongitude);
    let order = part.layers.iter().map(|(name, _)| *name).collect::<Vec<_>>().join("\n");
    let own = part.attributes.iter().map(|(name, text)| (*name, text.clone()));
    for (name, text) in own.chain([(ORDER, order)]) {
        if let (Some(name), Some(text)) = (Text::new_or_none(name), Text::new_or_none(text)) {
            attributes.other.insert(name, AttributeValue::Text(text));
        }
    }
    let size = (first.width as usize, first.height as usize);
    Ok(ExrPart::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels)))
}

/// Reads every RGB layer of a file, in the order they were written or else by name; a layer without
/// one of its three channels is left out.
///
/// # Errors
/// [`IoError::Read`] naming the file and the cause, for anything that is not a whole EXR file with
/// at least one such layer.
pub fn read_layers(path: &Path) -> Result<Vec<(String, LinearImage)>, IoError> {
    Ok(read_all(path)?.into_iter().map(|found| (found.name, found.image)).collect())
}

/// The first RGB layer of a file, and whether it says that it is a latitude–longitude map.
///
/// # Errors
/// Those of [`read_layers`].
pub fn read_first(path: &Path) -> Result<(LinearImage, bool), IoError> {
    let first = read_all(path)?.into_iter().next();
    let first = first.ok_or_else(|| IoError::read(path, "it has no layer"))?;
    Ok((first.image, first.is_environment))
}

/// A layer as it was read.
struct Found {
    name: String,
    image: LinearImage,
    is_environment: bool,
}

fn read_all(path: &Path) -> Result<Vec<Found>, IoError> {
    let bytes = std::fs::read(path).map_err(|cause| IoError::read(path, cause))?;
    // No damage tried in the tests makes the decoder panic; should some other, it becomes an error too.
    catch_unwind(AssertUnwindSafe(|| decode(&bytes)))
        .unwrap_or_else(|_| Err("the file is corrupt".into()))
        .map_err(|cause| IoError::read(path, cause))
}

fn decode(bytes: &[u8]) -> Result<Vec<Found>, String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    let promised = meta.headers.iter().fold(0u64, |sum, header| {
        let pixels = (header.layer_size.0 as u64).saturating_mul(header.layer_size.1 as u64);
        sum.saturating_add(pixels.saturating_mul(header.channels.bytes_per_pixel as u64))
    });
    if promised > LARGEST_COMPRESSION.saturating_mul(bytes.len() as u64) {
        return Err(format!("its header promises {promised} bytes of pixels, the file has {}", bytes.len()));
    }
    let image: FlatImage = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let mut layers = Vec::new();
    for part in &image.layer_data {
        let size = part.size;
        let mut found: BTreeMap<String, [Option<&FlatSamples>; 3]> = BTreeMap::new();
        let own = part.attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for channel in &part.channel_data.list {
            let name = channel.name.to_string();
            let (layer, letter) = name.rsplit_once('.').unwrap_or((&own, &name));
            let place = match letter {
                "R" | "r" => 0,
                "G" | "g" => 1,
                "B" | "b" => 2,
                _ => continue,
            };
            if channel.sample_data.len() == size.0 * size.1 {
                found.entry(layer.to_owned()).or_default()[place] = Some(&channel.sample_data);
            }
        }
        let order: Vec<String> = match part.attributes.other.get(&Text::from(ORDER)) {
            Some(AttributeValue::Text(text)) => text.to_string().split('\n').map(str::to_owned).collect(),
            _ => Vec::new(),
        };
        // Plain channels of a part with a name are the layer of that name.
        let written = |name: &str| if name == own { String::new() } else { name.to_owned() };
        let rank = |name: &str| order.iter().position(|o| *o == written(name)).unwrap_or(order.len());
        let mut named: Vec<_> = found.into_iter().collect();
        named.sort_by_key(|(name, _)| rank(name));
        for (name, channels) in named {
            if let [Some(r), Some(g), Some(b)] = channels {
                let image = image_from([r, g, b], size.0, size.1);
                let map = part.attributes.environment_map;
                let is_environment = map == Some(EnvironmentMap::LatitudeLongitude);
                layers.push(Found { name, image, is_environment });
            }
        }
    }
    if layers.is_empty() { Err("it has no layer with the channels R, G and B".into()) } else { Ok(layers) }
}

fn image_from(channels: [&FlatSamples; 3], width: usize, height: usize) -> LinearImage {
    let [r, g, b] = channels.map(FlatSamples::values_as_f32);
    let pixels = r.zip(g).zip(b).map(|((r, g), b)| Vec3::new(r, g, b)).collect();
    LinearImage { width: width as u32, height: height as u32, pixels }
}
