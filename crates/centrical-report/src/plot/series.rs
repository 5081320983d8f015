//! Plots as data: axes, series, points.

/// A plot: a title, two axes and series, drawn in the order they were added.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
    pub(crate) has_decimal_comma: bool,
    pub(crate) is_panel: bool,
}

/// An axis. Its range spans the data unless one is given.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub(crate) label: String,
    pub(crate) scale: Scale,
    pub(crate) range: Option<(f64, f64)>,
}

/// How values become lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scale {
    /// In proportion.
    Linear,
    /// By logarithm; values that are not positive have no place and are left out.
    Log,
}

/// Points under one name.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub(crate) label: String,
    pub(crate) mark: Mark,
    pub(crate) points: Vec<Point>,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A line through the points; a point that cannot be drawn breaks it.
    Line,
    /// A marker on every point, with its error bar.
    Markers,
    /// Both.
    LineAndMarkers,
}

/// One point, with an interval of y if it has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
    /// Ends of the error bar.
    pub interval: Option<(f64, f64)>,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, series: Vec::new(), has_decimal_comma: false, is_panel: false }
    }

    /// The plot with one more series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// The plot with decimal commas in its numbers.
    #[must_use]
    pub fn with_decimal_comma(mut self) -> Self {
        self.has_decimal_comma = true;
        self
    }

    /// The plot in the size of a panel: several stand side by side, or one fills a telephone.
    #[must_use]
    pub fn as_panel(mut self) -> Self {
        self.is_panel = true;
        self
    }
}

impl Axis {
    /// A linear axis; the label names quantity and unit.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis; the label names quantity and unit.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, range: None }
    }

    /// The axis from `low` to `high` whatever the data.
    #[must_use]
    pub fn with_range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }
}

impl Series {
    /// A line.
    pub fn line(label: impl Into<String>, points: Vec<Point>) -> Self {
        Self { label: label.into(), mark: Mark::Line, points }
    }

    /// Markers with error bars.
    pub fn markers(label: impl Into<String>, points: Vec<Point>) -> Self {
        Self { label: label.into(), mark: Mark::Markers, points }
    }

    /// Markers with error bars, joined by a line.
    pub fn line_and_markers(label: impl Into<String>, points: Vec<Point>) -> Self {
        Self { label: label.into(), mark: Mark::LineAndMarkers, points }
    }
}

impl Point {
    /// A point without an interval.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y, interval: None }
    }

    /// The point with an error bar from `low` to `high`.
    #[must_use]
    pub fn with_interval(mut self, low: f64, high: f64) -> Self {
        self.interval = Some((low, high));
        self
    }
}
