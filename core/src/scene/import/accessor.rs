//! glTF accessors read with every range checked.

use ::gltf::accessor::{Accessor, DataType, Dimensions};

/// Most elements taken from one accessor.
const LARGEST_COUNT: usize = 1 << 28;

/// All components of an accessor in order, as numbers; normalised integers become [0, 1] or [−1, 1].
///
/// # Errors
/// With the cause in words, if the accessor reaches outside its buffer.
pub fn numbers(accessor: &Accessor, dimensions: Dimensions, buffers: &[Vec<u8>]) -> Result<Vec<f64>, String> {
    let name = format!("accessor {}", accessor.index());
    if accessor.dimensions() != dimensions {
        return Err(format!("{name} is {:?}; {dimensions:?} is needed", accessor.dimensions()));
    }
    let (count, width) = (accessor.count(), dimensions.multiplicity());
    if count > LARGEST_COUNT {
        return Err(format!("{name} has {count} elements; at most {LARGEST_COUNT} are taken"));
    }
    let kind = accessor.data_type();
    let mut out = match accessor.view() {
        Some(view) => {
            let bytes = view_bytes(&view, buffers)?;
            let stride = view.stride().unwrap_or(kind.size() * width);
            elements(bytes, accessor.offset(), stride, count, width, kind)
                .ok_or_else(|| format!("{name} reaches outside its buffer"))?
        }
        None if accessor.sparse().is_some() => {
            if count > LARGEST_COUNT / 16 {
                return Err(format!("{name} has {count} elements and no data"));
            }
            vec![0.0; count * width]
        }
        None => return Err(format!("{name} has no data")),
    };
    if let Some(sparse) = accessor.sparse() {
        let (at, values) = (sparse.indices(), sparse.values());
        let index_kind = match at.index_type() {
            ::gltf::accessor::sparse::IndexType::U8 => DataType::U8,
            ::gltf::accessor::sparse::IndexType::U16 => DataType::U16,
            ::gltf::accessor::sparse::IndexType::U32 => DataType::U32,
        };
        let short = || format!("sparse part of {name} reaches outside its buffer");
        let n = sparse.count();
        let size = index_kind.size();
        let where_to = elements(view_bytes(&at.view(), buffers)?, at.offset(), size, n, 1, index_kind);
        let size = kind.size() * width;
        let what = elements(view_bytes(&values.view(), buffers)?, values.offset(), size, n, width, kind);
        let (where_to, what) = (where_to.ok_or_else(short)?, what.ok_or_else(short)?);
        for (i, value) in where_to.iter().zip(what.chunks(width)) {
            let first = *i as usize * width;
            out.get_mut(first..first + width).ok_or_else(short)?.copy_from_slice(value);
        }
    }
    if accessor.normalized() {
        let largest = match kind {
            DataType::I8 => 127.0,
            DataType::U8 => 255.0,
            DataType::I16 => 32_767.0,
            DataType::U16 => 65_535.0,
            DataType::U32 => f64::from(u32::MAX),
            DataType::F32 => 1.0,
        };
        out.iter_mut().for_each(|v| *v = (*v / largest).max(if kind == DataType::F32 { *v } else { -1.0 }));
    }
    Ok(out)
}

/// The bytes of a buffer view.
///
/// # Errors
/// With the cause in words, if the view reaches outside its buffer.
pub fn view_bytes<'a>(view: &::gltf::buffer::View, buffers: &'a [Vec<u8>]) -> Result<&'a [u8], String> {
    let end = view.offset().checked_add(view.length());
    buffers
        .get(view.buffer().index())
        .and_then(|bytes| bytes.get(view.offset()..end?))
        .ok_or_else(|| format!("buffer view {} reaches outside its buffer", view.index()))
}

fn elements(
    bytes: &[u8],
    offset: usize,
    stride: usize,
    count: usize,
    width: usize,
    kind: DataType,
) -> Option<Vec<f64>> {
    let size = kind.size();
    if count == 0 {
        return Some(Vec::new());
    }
    let last = (count - 1).checked_mul(stride)?.checked_add(offset)?.checked_add(size * width)?;
    if last > bytes.len() {
        return None;
    }
    let mut out = Vec::with_capacity(count * width);
    for element in 0..count {
        for component in 0..width {
            let at = offset + element * stride + component * size;
            out.push(number(bytes.get(at..at + size)?, kind)?);
        }
    }
    Some(out)
}

fn number(bytes: &[u8], kind: DataType) -> Option<f64> {
    Some(match kind {
        DataType::I8 => f64::from(bytes[0] as i8),
        DataType::U8 => f64::from(bytes[0]),
        DataType::I16 => f64::from(i16::from_le_bytes(bytes.try_into().ok()?)),
        DataType::U16 => f64::from(u16::from_le_bytes(bytes.try_into().ok()?)),
        DataType::U32 => f64::from(u32::from_le_bytes(bytes.try_into().ok()?)),
        DataType::F32 => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
    })
}
