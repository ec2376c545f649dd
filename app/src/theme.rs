//! How the program looks: one dark theme and one light one, greys that leave colour to the picture.

use egui::{
    Color32, Context, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, Style, TextStyle, Theme,
    Visuals, style::WidgetVisuals, vec2,
};

/// Colours of one theme.
#[derive(Clone, Copy)]
struct Greys {
    sunken: Color32,
    panel: Color32,
    raised: Color32,
    widget: Color32,
    hovered: Color32,
    line: Color32,
    weak: Color32,
    text: Color32,
    strong: Color32,
    accent: Color32,
    accent_fill: Color32,
    on_accent: Color32,
}

const DARK: Greys = Greys {
    sunken: Color32::from_rgb(18, 18, 20),
    panel: Color32::from_rgb(27, 27, 30),
    raised: Color32::from_rgb(35, 35, 39),
    widget: Color32::from_rgb(45, 45, 50),
    hovered: Color32::from_rgb(58, 58, 64),
    line: Color32::from_rgb(50, 50, 55),
    weak: Color32::from_rgb(142, 142, 150),
    text: Color32::from_rgb(205, 205, 210),
    strong: Color32::from_rgb(242, 242, 244),
    accent: Color32::from_rgb(245, 177, 76),
    accent_fill: Color32::from_rgb(108, 74, 24),
    on_accent: Color32::from_rgb(255, 232, 196),
};

const LIGHT: Greys = Greys {
    sunken: Color32::from_rgb(252, 252, 252),
    panel: Color32::from_rgb(240, 240, 241),
    raised: Color32::from_rgb(248, 248, 249),
    widget: Color32::from_rgb(223, 223, 226),
    hovered: Color32::from_rgb(209, 209, 213),
    line: Color32::from_rgb(205, 205, 209),
    weak: Color32::from_rgb(105, 105, 112),
    text: Color32::from_rgb(50, 50, 55),
    strong: Color32::from_rgb(15, 15, 18),
    accent: Color32::from_rgb(176, 103, 4),
    accent_fill: Color32::from_rgb(250, 210, 146),
    on_accent: Color32::from_rgb(64, 36, 0),
};

/// Gives a context both themes.
pub fn install(ctx: &Context) {
    // Hack draws the arrows and mathematical signs that the text face lacks.
    let mut faces = egui::FontDefinitions::default();
    if let Some(text) = faces.families.get_mut(&FontFamily::Proportional) {
        text.push("Hack".to_owned());
    }
    ctx.set_fonts(faces);
    for (theme, greys) in [(Theme::Dark, DARK), (Theme::Light, LIGHT)] {
        ctx.style_mut_of(theme, |style| {
            fonts(style);
            spacing(style);
            style.visuals = visuals(theme, greys);
        });
    }
}

/// The accent: what is selected, and what needs the eye.
pub fn accent(visuals: &Visuals) -> Color32 {
    greys(visuals).accent
}

/// Fill behind what stands out from a panel.
pub fn raised(visuals: &Visuals) -> Color32 {
    greys(visuals).raised
}

fn greys(visuals: &Visuals) -> Greys {
    if visuals.dark_mode { DARK } else { LIGHT }
}

fn fonts(style: &mut Style) {
    let sizes = [
        (TextStyle::Small, 11.0, FontFamily::Proportional),
        (TextStyle::Body, 13.0, FontFamily::Proportional),
        (TextStyle::Button, 13.0, FontFamily::Proportional),
        (TextStyle::Heading, 17.0, FontFamily::Proportional),
        (TextStyle::Monospace, 12.0, FontFamily::Monospace),
    ];
    style.text_styles = sizes.map(|(kind, size, family)| (kind, FontId::new(size, family))).into();
}

fn spacing(style: &mut Style) {
    let s = &mut style.spacing;
    s.item_spacing = vec2(7.0, 5.0);
    s.button_padding = vec2(7.0, 3.0);
    s.interact_size = vec2(34.0, 21.0);
    s.slider_width = 110.0;
    s.slider_rail_height = 4.0;
    s.indent = 14.0;
    s.window_margin = Margin::same(12);
    s.menu_margin = Margin::same(6);
    s.tooltip_width = 340.0;
    s.icon_width = 15.0;
    s.icon_width_inner = 9.0;
    style.animation_time = 0.1;
}

fn visuals(theme: Theme, g: Greys) -> Visuals {
    let mut v = theme.default_visuals();
    let radius = CornerRadius::same(4);
    let widget = |fill: Color32, line: Color32, text: Color32| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::new(1.0, line),
        corner_radius: radius,
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    v.widgets.noninteractive = widget(g.panel, g.line, g.text);
    v.widgets.inactive = widget(g.widget, Color32::TRANSPARENT, g.text);
    v.widgets.hovered = widget(g.hovered, g.hovered, g.strong);
    v.widgets.active = widget(g.hovered, g.accent, g.strong);
    v.widgets.open = widget(g.hovered, g.line, g.strong);
    v.selection.bg_fill = g.accent_fill;
    v.selection.stroke = Stroke::new(1.0, g.on_accent);
    v.hyperlink_color = g.accent;
    v.weak_text_color = Some(g.weak);
    v.faint_bg_color = g.raised;
    v.extreme_bg_color = g.sunken;
    v.code_bg_color = g.raised;
    v.warn_fg_color = g.accent;
    v.error_fg_color =
        if v.dark_mode { Color32::from_rgb(240, 105, 95) } else { Color32::from_rgb(180, 35, 25) };
    v.panel_fill = g.panel;
    v.window_fill = g.raised;
    v.window_stroke = Stroke::new(1.0, g.line);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    let shade = Shadow { offset: [0, 4], blur: 16, spread: 0, color: Color32::from_black_alpha(90) };
    v.window_shadow = shade;
    v.popup_shadow = shade;
    v.slider_trailing_fill = true;
    v.striped = false;
    v
}
