use centrical_report::plot::{Axis, Plot, Point, Series};
use roxmltree::Document;

fn count(svg: &str, class: &str) -> usize {
    let document = Document::parse(svg).unwrap();
    // Legend entries stand outside the inner drawing.
    let inner = document.root_element().children().find(|node| node.has_tag_name(SVG)).unwrap();
    inner.descendants().filter(|node| node.attribute("class") == Some(class)).count()
}

const SVG: (&str, &str) = ("http://www.w3.org/2000/svg", "svg");

fn first_line(svg: &str) -> String {
    let document = Document::parse(svg).unwrap();
    let inner = document.root_element().children().find(|node| node.has_tag_name(SVG)).unwrap();
    let line = inner.descendants().find(|node| node.attribute("class") == Some("line")).unwrap();
    line.attribute("d").unwrap().to_owned()
}

fn points(values: &[(f64, f64)]) -> Vec<Point> {
    values.iter().map(|&(x, y)| Point::new(x, y)).collect()
}

#[test]
fn any_text_and_any_number_give_well_formed_svg_with_every_drawable_point() {
    let nasty = [(1.0, 2.0), (f64::NAN, 1.0), (3.0, f64::INFINITY), (-1.0, 1e300), (0.0, -5e-324), (1e-300, 1.0)];
    for (axis, drawable) in [(Axis::linear as fn(String) -> Axis, 4), (Axis::log, 2)] {
        let title = "a < b & \"c\" \u{7}> d";
        let plot = Plot::new(title, axis("x <".to_owned()), axis("&".to_owned()))
            .with(Series::line_and_markers("é < &", points(&nasty)));
        let svg = plot.to_svg();
        assert_eq!(count(&svg, "mark"), drawable);
        assert_eq!(svg, plot.to_svg());
        let document = Document::parse(&svg).unwrap();
        assert_eq!(document.root_element().attribute("aria-label"), Some("a < b & \"c\" \u{fffd}> d"));
    }
    Document::parse(&Plot::new("empty", Axis::log(""), Axis::linear("")).to_svg()).unwrap();
}

#[test]
fn a_point_that_cannot_be_drawn_breaks_the_line() {
    let plot = Plot::new("", Axis::linear(""), Axis::log(""))
        .with(Series::line("", points(&[(0.0, 1.0), (1.0, 2.0), (2.0, 0.0), (3.0, 4.0), (4.0, 5.0)])));
    let line = first_line(&plot.to_svg());
    assert_eq!((line.matches('M').count(), line.matches('L').count()), (2, 2), "{line}");
}

#[test]
fn a_long_line_is_thinned_but_keeps_its_spike() {
    let mut values: Vec<(f64, f64)> = (0..200_000).map(|k| (f64::from(k), f64::from(k % 3))).collect();
    values[123_456].1 = 50.0;
    let plot = Plot::new("", Axis::linear(""), Axis::linear("").with_range(0.0, 50.0));
    let line = first_line(&plot.with(Series::line("", points(&values))).to_svg());
    assert!(line.len() < 60_000, "{} bytes", line.len());
    // The range ends at the spike, so the spike touches the frame's upper edge, which is 0.
    let heights = line.split(['M', 'L']).filter_map(|place| place.split(' ').nth(1)?.parse::<f64>().ok());
    assert_eq!(heights.fold(f64::INFINITY, f64::min), 0.0);
}

#[test]
fn hovering_shows_the_values() {
    let point = Point::new(10.0, 0.00025).with_interval(0.0002, 0.0003);
    let svg = Plot::new("", Axis::log(""), Axis::log("")).with(Series::markers("axis 1", vec![point])).to_svg();
    assert!(svg.contains("<title>axis 1: 10.000, 2.5000e-4 (2.0000e-4 .. 3.0000e-4)</title>"), "{svg}");
    assert_eq!(count(&svg, "bar"), 1);
}

#[test]
fn an_error_bar_without_a_lower_end_reaches_out_of_the_plot() {
    let point = |low| Point::new(1.0, 1.0).with_interval(low, 2.0);
    let svg = |low| Plot::new("", Axis::log(""), Axis::log("")).with(Series::markers("", vec![point(low)])).to_svg();
    assert_eq!(count(&svg(0.0), "bar"), 1);
    assert_ne!(svg(0.0), svg(0.5));
}
