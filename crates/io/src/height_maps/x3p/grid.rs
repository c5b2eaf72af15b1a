//! Axes of the grid, as main.xml describes them.

use roxmltree::Node;

use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::xml;

/// The regular grid of a surface.
pub(super) struct Grid {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) spacing: [f64; 2],
    /// Type of the numbers, of which heights are `offset + increment * number`.
    pub(super) kind: SampleKind,
    pub(super) increment: f64,
    pub(super) offset: f64,
}

impl Grid {
    pub(super) fn parse(root: Node<'_, '_>) -> Result<Self, ReadProblem> {
        if root.tag_name().name() != "ISO5436_2" {
            return Err(ReadProblem::malformed(format_args!(
                "the root of its main.xml is `{}`, but ISO5436_2 is needed",
                root.tag_name().name()
            )));
        }
        let first = xml::child(root, "Record1")?;
        if let Some(feature) = xml::optional(first, "FeatureType")?
            && xml::text(feature) != "SUR"
        {
            return Err(ReadProblem::unsupported(format_args!(
                "its feature type is `{}`, but only surfaces on a grid (SUR) are read",
                xml::text(feature)
            )));
        }
        let axes = xml::child(first, "Axes")?;
        let spacing = spacing(axes)?;
        let heights = HeightAxis::parse(axes)?;
        let [columns, rows] = matrix_size(root)?;
        Ok(Self {
            columns,
            rows,
            spacing,
            kind: heights.kind,
            increment: heights.increment,
            offset: heights.offset,
        })
    }
}

/// Spacing along CX and CY.
fn spacing(axes: Node<'_, '_>) -> Result<[f64; 2], ReadProblem> {
    let mut spacing = [0.0; 2];
    for (name, spacing) in ["CX", "CY"].into_iter().zip(&mut spacing) {
        let axis = xml::child(axes, name)?;
        let kind = xml::child_text(axis, "AxisType")?;
        if kind != "I" {
            return Err(ReadProblem::unsupported(format_args!(
                "its axis {name} is of type `{kind}`, with a coordinate for each point, but only regular grids (type I, incremental) are read"
            )));
        }
        let increment = xml::child(axis, "Increment")?;
        *spacing = xml::number("Increment", xml::text(increment))?;
    }
    Ok(spacing)
}

/// The axis CZ.
struct HeightAxis {
    kind: SampleKind,
    increment: f64,
    offset: f64,
}

impl HeightAxis {
    fn parse(axes: Node<'_, '_>) -> Result<Self, ReadProblem> {
        let axis = xml::child(axes, "CZ")?;
        if let Some(kind) = xml::optional(axis, "AxisType")?
            && xml::text(kind) != "A"
        {
            return Err(ReadProblem::unsupported(format_args!(
                "its axis CZ is of type `{}`, but heights must be absolute (type A)",
                xml::text(kind)
            )));
        }
        let kind = match xml::child_text(axis, "DataType")? {
            "I" => SampleKind::I16,
            "L" => SampleKind::I32,
            "F" => SampleKind::F32,
            "D" => SampleKind::F64,
            other => {
                return Err(ReadProblem::malformed(format_args!(
                    "the data type of CZ is `{other}`, but allowed are I, L, F and D"
                )));
            }
        };
        let number = |name| {
            xml::optional(axis, name)?
                .map(|node| xml::number(name, xml::text(node)))
                .transpose()
        };
        let increment = number("Increment")?;
        let whole = matches!(kind, SampleKind::I16 | SampleKind::I32);
        if whole && increment.is_none() {
            return Err(ReadProblem::malformed(
                "its heights are whole numbers, but CZ has no Increment to make metres of them",
            ));
        }
        let (increment, offset) = (increment.unwrap_or(1.0), number("Offset")?.unwrap_or(0.0));
        if !(increment.is_finite() && increment != 0.0 && offset.is_finite()) {
            return Err(ReadProblem::malformed(format_args!(
                "CZ has Increment {increment} and Offset {offset}, which must be finite, the first not zero"
            )));
        }
        Ok(Self {
            kind,
            increment,
            offset,
        })
    }
}

/// Columns and rows.
fn matrix_size(root: Node<'_, '_>) -> Result<[usize; 2], ReadProblem> {
    let third = xml::child(root, "Record3")?;
    let Some(size) = xml::optional(third, "MatrixDimension")? else {
        return Err(ReadProblem::unsupported(
            "it has no MatrixDimension and so is a list of points, but only regular grids are read",
        ));
    };
    let length = |name| {
        let text = xml::child_text(size, name)?;
        text.parse::<u64>().map_err(|_| {
            ReadProblem::malformed(format_args!(
                "{name} is `{text}`, but a positive whole number is needed"
            ))
        })
    };
    let layers = length("SizeZ")?;
    if layers != 1 {
        return Err(ReadProblem::unsupported(format_args!(
            "it has {layers} layers (SizeZ), but one is needed"
        )));
    }
    Ok([length("SizeX")?, length("SizeY")?].map(|n| usize::try_from(n).unwrap_or(usize::MAX)))
}
