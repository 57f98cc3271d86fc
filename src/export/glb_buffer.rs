//! The binary part of a GLB: arrays of numbers, the views on them and what they mean.
//!
//! Every array begins at a multiple of four bytes, as glTF 2.0 section 3.6.2.4 asks of the longest numbers.

use serde_json::{Value, json};

/// Types of numbers.
const I8: u32 = 5120;
const F32: u32 = 5126;
const U16: u32 = 5123;
const U32: u32 = 5125;

/// Where arrays begin, in bytes.
const ALIGNED: usize = 4;

/// What a view is used for.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Bytes, the views on them and their accessors.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Times of keys in seconds; their bounds are required.
    pub(super) fn scalars(&mut self, values: &[f64]) -> usize {
        let values: Vec<[f32; 1]> = values.iter().map(|v| [*v as f32]).collect();
        self.push_floats(&values, "SCALAR", None, true)
    }

    /// Rotations (x, y, z, w).
    pub(super) fn push_rotations(&mut self, values: &[[f32; 4]]) -> usize {
        self.push_floats(values, "VEC4", None, false)
    }

    /// Vectors of an animation.
    pub(super) fn keys(&mut self, values: &[[f32; 3]]) -> usize {
        self.push_floats(values, "VEC3", None, false)
    }

    /// Vectors of a mesh; positions need their bounds.
    pub(super) fn vertices(&mut self, values: &[[f32; 3]], bounds: bool) -> usize {
        self.push_floats(values, "VEC3", Some(VERTICES), bounds)
    }

    /// Corners as shares of a cube, two bytes a coordinate, and their normals, one byte a coordinate: both padded to fours.
    pub(super) fn quantised(&mut self, shares: &[[u16; 3]], normals: &[[i8; 3]]) -> [usize; 2] {
        let bytes: Vec<u8> = shares
            .iter()
            .flat_map(|[x, y, z]| [*x, *y, *z, 0].map(u16::to_le_bytes))
            .flatten()
            .collect();
        let fold = |start: u16, pick: fn(u16, u16) -> u16| -> [u16; 3] {
            std::array::from_fn(|i| shares.iter().fold(start, |end, share| pick(end, share[i])))
        };
        let mut corners = self.short_vectors(&bytes, 8, U16);
        corners["min"] = json!(fold(u16::MAX, u16::min));
        corners["max"] = json!(fold(0, u16::max));
        let bytes: Vec<u8> = normals
            .iter()
            .flat_map(|[x, y, z]| [*x, *y, *z, 0].map(|v| v as u8))
            .collect();
        let normals = self.short_vectors(&bytes, 4, I8);
        [corners, normals].map(|accessor| self.push_accessor(accessor))
    }

    /// The accessor of vectors whose numbers are shares of the largest one of their type and begin so many bytes after each other.
    fn short_vectors(&mut self, bytes: &[u8], stride: usize, kind: u32) -> Value {
        let view = self.push_view(bytes, Some(VERTICES));
        self.views[view]["byteStride"] = stride.into();
        json!({
            "bufferView": view,
            "componentType": kind,
            "normalized": true,
            "count": bytes.len() / stride,
            "type": "VEC3",
        })
    }

    /// Corners of triangles: two bytes each where all of them fit. The largest number of a type restarts a primitive.
    pub(super) fn indices(&mut self, values: &[u32]) -> usize {
        let short: Option<Vec<u16>> = (values.iter())
            .map(|v| u16::try_from(*v).ok().filter(|v| *v < u16::MAX))
            .collect();
        let (bytes, kind): (Vec<u8>, u32) = match short {
            Some(short) => (short.iter().flat_map(|v| v.to_le_bytes()).collect(), U16),
            None => (values.iter().flat_map(|v| v.to_le_bytes()).collect(), U32),
        };
        let view = self.push_view(&bytes, Some(INDICES));
        self.push_accessor(json!({
            "bufferView": view,
            "componentType": kind,
            "count": values.len(),
            "type": "SCALAR",
        }))
    }

    /// The views, the accessors and the bytes.
    pub(super) fn into_parts(self) -> (Vec<Value>, Vec<Value>, Vec<u8>) {
        (self.views, self.accessors, self.bytes)
    }

    fn push_floats<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
        bounds: bool,
    ) -> usize {
        let numbers = values.as_flattened().iter();
        let bytes: Vec<u8> = numbers.flat_map(|v| v.to_le_bytes()).collect();
        let view = self.push_view(&bytes, target);
        let mut accessor = json!({
            "bufferView": view,
            "componentType": F32,
            "count": values.len(),
            "type": kind,
        });
        if let (true, Some(first)) = (bounds, values.first()) {
            let fold = |pick: fn(f32, f32) -> f32| {
                let ends = values.iter().fold(*first, |ends, value| {
                    std::array::from_fn(|i| pick(ends[i], value[i]))
                });
                ends.to_vec()
            };
            accessor["min"] = json!(fold(f32::min));
            accessor["max"] = json!(fold(f32::max));
        }
        self.push_accessor(accessor)
    }

    fn push_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
        });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        let end = self.bytes.len().next_multiple_of(ALIGNED);
        self.bytes.resize(end, 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn push_accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
