//! The programs themselves: valid, and with room for the trees they follow.

use lumenscope_core::gpu::{shaders, tables};

#[test]
fn every_program_is_valid_wgsl() {
    // Needed to unpack halves, which WGSL has without any extension.
    let half = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    for program in shaders::ALL {
        let source = program.source();
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|e| panic!("{}: {}", program.name, e.emit_to_string(&source)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), half)
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {}", program.name, e.emit_to_string(&source)));
    }
}

/// A tree of `levels` inner nodes in a chain, each with a leaf beside the next.
fn chain(levels: u32) -> Vec<tables::Node> {
    let node = |first, count| tables::Node { first, count, ..bytemuck::Zeroable::zeroed() };
    let inner = (0..levels).flat_map(|i| [node(2 * i + 1, 0), node(0, 1)]);
    let mut nodes: Vec<_> = inner.collect();
    nodes.push(node(0, 1));
    // Children stand side by side: the inner one is the second of each pair but the last.
    for i in 1..nodes.len() - 1 {
        if i % 2 == 1 {
            nodes.swap(i, i + 1);
        }
    }
    for (i, node) in nodes.iter_mut().enumerate().filter(|(_, n)| n.count == 0) {
        node.first = i as u32 + 1;
    }
    nodes
}

#[test]
fn a_tree_too_deep_for_the_shaders_is_refused_with_a_reason() {
    let source = shaders::SHADE.source();
    assert!(
        source.contains(&format!("const STACK: u32 = {}u;", tables::MOST_LEVELS)),
        "one stack, two sides"
    );
    for levels in [0, 1, 5, tables::MOST_LEVELS, tables::MOST_LEVELS + 6] {
        assert_eq!(tables::levels(&chain(levels), 0), levels);
    }
    assert!(tables::check_levels(&chain(tables::MOST_LEVELS), 0).is_ok());
    let error = tables::check_levels(&chain(tables::MOST_LEVELS + 6), 0).unwrap_err();
    assert!(error.to_string().contains("70") && error.to_string().contains("64"), "{error}");
}
