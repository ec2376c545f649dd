//! Fields of light as images: false colour, kept as textures until what they show changes.

use egui::{Color32, ColorImage, Rect, Sense, TextureHandle, TextureOptions, Ui, pos2, vec2};
use glam::Vec3;
use lumenscope_core::math::{
    colour::{luminance, srgb8},
    false_colour::FalseColour,
    image::LinearImage,
};

/// An image of the window, with what stands over it.
pub struct Field {
    title: String,
    image: ColorImage,
    texture: Option<TextureHandle>,
}

impl Field {
    /// An image in false colour, by luminance; grey where `known` says that nothing is known.
    pub fn new(
        title: impl Into<String>,
        image: &LinearImage,
        colours: &FalseColour,
        known: impl Fn(usize) -> bool,
    ) -> Self {
        Self::signed(title, [image.width, image.height], colours, |i| {
            known(i).then(|| luminance(image.pixels[i]))
        })
    }

    /// An image of numbers, row by row, in false colour; grey where there is none.
    pub fn signed(
        title: impl Into<String>,
        [width, height]: [u32; 2],
        colours: &FalseColour,
        value: impl Fn(usize) -> Option<f32>,
    ) -> Self {
        let pixel = |i: usize| match value(i).filter(|v| v.is_finite()) {
            Some(value) => srgb8(colours.colour(value)),
            None => UNKNOWN,
        };
        Self::of_pixels(title, [width, height], (0..(width * height) as usize).map(pixel))
    }

    /// An image of pixels as they are on the display.
    pub fn of_pixels(
        title: impl Into<String>,
        [width, height]: [u32; 2],
        pixels: impl Iterator<Item = [u8; 3]>,
    ) -> Self {
        let pixels = pixels.map(|[r, g, b]| Color32::from_rgb(r, g, b)).collect();
        let image = ColorImage::new([width as usize, height as usize], pixels);
        Self { title: title.into(), image, texture: None }
    }

    /// Shows it `width` points wide; returns where the pointer is on it, from 0 to 1.
    pub fn show(&mut self, ui: &mut Ui, width: f32, aspect: f32) -> Option<[f32; 2]> {
        let mut at = None;
        ui.vertical(|ui| {
            ui.set_width(width);
            ui.label(egui::RichText::new(&self.title).small());
            let texture = self.texture.get_or_insert_with(|| {
                ui.ctx().load_texture(&self.title, self.image.clone(), TextureOptions::NEAREST)
            });
            let size = vec2(width, (width * aspect).clamp(8.0, 3.0 * width));
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            let name = format!("image: {}", self.title);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
            at = response.hover_pos().map(|p| {
                let share = (p - rect.min) / rect.size();
                [share.x.clamp(0.0, 1.0), share.y.clamp(0.0, 1.0)]
            });
        });
        at
    }
}

/// Where nothing is known.
pub const UNKNOWN: [u8; 3] = [28, 28, 30];

/// Size that 98 of 100 values stay below by luminance, so that one texel beside a lamp does not take all colours.
pub fn bulk(values: impl Iterator<Item = Vec3>) -> f32 {
    let mut sizes: Vec<f32> = values.map(|v| luminance(v).abs()).filter(|v| v.is_finite()).collect();
    sizes.sort_by(f32::total_cmp);
    sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0).max(1e-6)
}
