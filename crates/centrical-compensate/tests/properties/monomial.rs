use centrical_compensate::Monomial;

#[test]
fn gradient_equals_differences() {
    let f = [-1.5, 0.8, 2.1];
    let monomials = [
        Monomial::ONE,
        Monomial::power(0, 1),
        Monomial::power(2, 3),
        Monomial::power(1, 5),
        Monomial::product(&[0, 2]),
        Monomial::odd_square(0),
        Monomial::odd_square(1),
        Monomial { powers: [1, 2, 1], sign_of: Some(0) },
    ];
    for monomial in monomials {
        let gradient = monomial.gradient(f);
        for j in 0..3 {
            let at = |steps: f64| {
                let mut moved = f;
                moved[j] += 1e-3 * steps;
                monomial.value(moved)
            };
            let numeric = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12e-3;
            assert!((numeric - gradient[j]).abs() < 1e-11, "{monomial}");
        }
    }
    assert_eq!(Monomial::odd_square(0).value(f), -2.25);
}

#[test]
fn powers_equal_repeated_products() {
    // A power of two and three has exact powers, so that the order of the factors shows nowhere.
    for n in 0..=20 {
        assert_eq!(Monomial::power(1, n).value([0.0, 3.0, 0.0]), 3.0_f64.powi(n.into()), "{n}");
    }
}

#[test]
fn text_lists_components_in_order() {
    let shown = |powers, sign_of| Monomial { powers, sign_of }.to_string();
    assert_eq!(shown([0; 3], None), "1");
    assert_eq!(shown([0, 1, 0], Some(1)), "|f2|");
    assert_eq!(shown([1, 2, 0], Some(1)), "f1*f2*|f2|");
    assert_eq!(shown([3, 0, 1], None), "f1^3*f3");
}

#[test]
fn terms_are_read_and_written_in_one_way() {
    let cases = [
        ("1", "1"),
        ("f1", "f1"),
        (" f2 * f1 ", "f1*f2"),
        ("|f2|*f2", "f2*|f2|"),
        ("f3^2*f3", "f3^3"),
        ("|f1|^2", "f1^2"),
        ("|f1|^3", "f1^2*|f1|"),
        ("|f3|", "|f3|"),
        ("sgn(f2)", "sgn(f2)"),
        ("sgn(f1)*f1", "|f1|"),
        ("f1*f1*f2^2*|f3|", "f1^2*f2^2*|f3|"),
    ];
    for (text, expected) in cases {
        let read = Monomial::parse(text).unwrap();
        assert_eq!(read.to_string(), expected);
        assert_eq!(Monomial::parse(expected), Some(read), "{text}");
    }
}

#[test]
fn what_is_no_term_is_refused() {
    for text in ["", "f4", "f1*", "f1^0", "f1^-1", "f1^255*f1^255", "|f1|*|f2|", "f1+f2", "2*f1", "|f1"] {
        assert_eq!(Monomial::parse(text), None, "{text}");
    }
}
