use super::window_length;

#[test]
fn even_orientations_give_the_papers_window() {
    assert_eq!(window_length(0.7232, 100, 2000), 626);
}

#[test]
fn stays_within_its_bounds() {
    assert_eq!(window_length(0.0, 100, 2000), 2000);
    assert_eq!(window_length(1.3, 100, 2000), 100);
    assert_eq!(window_length(f64::NAN, 100, 2000), 2000);
    assert_eq!(window_length(-1.0, 100, 2000), 2000);
}
