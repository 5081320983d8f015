//! English.

use centrical::{
    Course, Difference, Extension, Extra, Group, Law, PairRelation, ReferencePoint, Rival, Source, Termination,
};
use centrical_session::{Follows, Method};

use super::messages::{Messages, Words};
use super::speeds;

/// English.
pub(crate) const ENGLISH: Messages = Messages {
    calibration_report: "Calibration report",
    acceptable: "Calibration acceptable",
    not_acceptable: "Calibration not acceptable",
    verdict_good: "The result can be used as it stands: the fit converged, the residuals agree with the stated \
        uncertainties, and every parameter of the instrument is determined.",
    verdict_bad: "The result must not be used as it stands:",
    serial: "Serial number",
    not_given: "not given",
    session: "Session",
    date: "Date",
    gravity: "Local gravity",
    latitude: "Latitude",
    pair_relation: "Relation of dR within a pair of positions",
    reference: "Reference point",
    speed_uncertainty: "Relative standard uncertainty of a speed",
    data: "Data",
    method: "Method",
    software: "Software",
    chi_squared: "χ² per degree of freedom",
    rank: "Rank",
    residual_error: "Reading error over the calibrated range",
    residual_error_note: "Over all plateaus, against the specific \
        force of the fitted geometry. The second row still holds the error of each plateau’s speed; the third is without \
        it, which along the arm leaves next to nothing, so it speaks for the axes across the arm and for rest. The last \
        row is the expanded uncertainty that the parameters leave in a compensated reading of the same force.",
    before: "Before compensation",
    after: "After compensation",
    after_speed_free: "After, less the speed error of each plateau",
    compensation_uncertainty: "Uncertainty of compensation, k = 2",
    axis: "axis",
    newtonometer: "Newtonometer",
    number_sign: "No.",
    parameters: "Parameters",
    parameters_note: "Value ± expanded uncertainty U = k·u for a coverage probability of 95.45 %: k = 2 for a normal \
        distribution; where the effective degrees of freedom are finite, that of Student’s distribution. 1 g = 9.80665 m/s².",
    mounting: "Geometry of the experiment",
    parameter: "Parameter",
    value: "Value ± U",
    unit: "Unit",
    value_si: "Value ± U, SI",
    not_determined: "not determined",
    budget: "Uncertainty budget",
    budget_note: "Standard uncertainty by source, in the customary unit of each parameter; – is less than a \
        thousandth of the combined one.",
    no_budget: "The session states no uncertainties of gravity, radii, attitudes and the like: they count as exact, and \
        the uncertainties hold what the fit weighs.",
    combined: "combined",
    degrees_word: "Eff. degrees of freedom",
    chi_squared_chance: "Chance of so large a χ²",
    outlying_plateaus: "plateaus that stand out",
    patterns_found: "patterns in the residuals",
    worst_mounting: "Worst of the mountings, each predicted from all others",
    steadiness: "Steadiness",
    steadiness_note: "How the readings moved within plateaus and over the session, and the tilt of the axis of \
        rotation by the once-per-revolution term, which is not fitted, against the fitted one. With standard \
        uncertainties; what comes by chance less often than once in a thousand is said to be there.",
    drift_over_plateau: "Drift over a plateau, mean",
    drift_over_session: "Drift over the session",
    plateaus_drift: "plateaus drift",
    session_drifts: "the session drifts",
    no_drift: "no drift seen",
    within_scatter: "no more than the plateaus scatter",
    run_again: "Plateaus run again",
    farthest_apart: "farthest apart",
    differ: "they differ",
    no_difference: "no difference seen",
    tilt_spinning: "Tilt by the once-per-revolution term",
    tilt_at_rest: "Tilt by rest",
    tilts_agree: "they agree",
    tilts_differ: "they differ: the axis is not the same while it spins, or something else turns with it",
    tilt_reversed: "it turns the other way: the sense of rotation is wrong",
    tilts_scatter: "the plateaus’ own tilts scatter",
    not_used: "Samples not used",
    spikes: "spikes",
    missing: "missing",
    stuck: "stuck",
    repeated: "repeated",
    positions: "Mounting positions",
    positions_caption: "Where the three sensitive axes point in each position: the arm goes to the right, the \
        rotation axis up.",
    position: "Position",
    pair: "pair",
    force_axis: "specific force along the loaded axis, g",
    error_before_axis: "reading error, mg",
    error_after_axis: "reading error, µg",
    before_caption: "Error of each newtonometer against the specific force along the axis loaded most, a marker for each \
        such axis: along its own axis the offset is the bias, the slope the scale error, the bend the quadratic and cubic \
        terms; along another, the slope is misalignment and the parabola a quadratic term across.",
    after_caption: "The same after compensation, less what an error of the plateau’s speed explains: points should keep \
        within their bars (k = 2) without a trend; along its own axis the speed explains nearly all, so that those points \
        lie at zero by construction.",
    residuals_title: "Residuals by plateau",
    residuals_caption: "Mean reading less fitted model with bars of k = 2, speed error included: bars that miss \
        zero more often than one in twenty, or a pattern along the session, would mean a model that does not fit.",
    normalised_title: "Residuals over their standard uncertainty",
    normalised_caption: "Residuals made independent and divided by their standard uncertainty: about one in twenty \
        should lie outside ±2.",
    plateau_axis: "plateau, in the order of the session",
    residual_axis: "residual, µg",
    normalised_axis: "normalised residual",
    correlation_title: "Correlation of the estimates",
    correlation_caption: "Rows are named on the left, columns at the diagonal. Blue is positive, orange negative, and strength is saturation: strongly coloured cells \
        away from the diagonal are parameters that the experiment separates badly.",
    singular_title: "Singular values of the design",
    singular_axis: "singular value",
    order_axis: "number, from the largest",
    singular_caption_full: "All of them lie above the limit: every combination of parameters is seen by the \
        experiment.",
    singular_caption_short: "Those below the limit belong to combinations that the experiment does not see; they \
        are named under the plot.",
    determined: "determined",
    lost: "not seen",
    limit: "limit",
    null_directions: "The readings do not change along",
    prediction_title: "Uncertainty of a compensated reading",
    prediction_axis: "expanded uncertainty (k = 2), µg",
    prediction_caption: "Expanded uncertainty, k = 2, that the calibration leaves in a compensated reading, for a force along each \
        axis alone; the noise of the reading itself comes on top.",
    history_title: "Uncertainty as the session was watched",
    history_caption: "Largest standard uncertainty of each group over that after the last plateau, as it stood when each \
        plateau had come. A curve begins where all of its group that was determined in the end was determined first.",
    convergence_title: "Uncertainty as the session goes on",
    convergence_axis: "standard uncertainty over the final one",
    convergence_caption: "The worst-known parameter of each group, against its final uncertainty: a curve that has \
        flattened gains little from more plateaus of the same kind.",
    plateaus_used_axis: "plateaus used",
    records_title: "Records with the plateaus found",
    records_caption: "Lowest and highest reading of the three axes over the record; the shaded stretches are the \
        plateaus whose means were used, and each should lie on level ground clear of the ramps.",
    mounting_word: "Mounting",
    radius: "radius",
    plateau: "plateau",
    samples: "samples",
    rejected: "rejected",
    time_axis: "time, s",
    stability_title: "Stability of the reading at rest",
    tau_axis: "averaging time τ, s",
    deviation_axis: "Allan deviation, m/s²",
    stability_caption: "Where the curve falls as the square root of time the noise is white; the level of its \
        lowest stretch is the bias instability.",
    inputs: "Input files",
    inputs_note: "Files from which the result was made, with the SHA-256 of their bytes.",
    file: "File",
    certificate: "Calibration certificate",
    certificate_number: "Certificate no.",
    page: "page",
    of: "of",
    laboratory: "Laboratory",
    accreditation: "accreditation",
    customer: "Customer",
    item: "Item calibrated",
    manufacturer: "Manufacturer",
    model: "Model",
    description: "Description",
    customer_number: "Customer’s number",
    condition: "Condition on receipt",
    received: "Received",
    calibrated: "Calibrated",
    issued: "Issued",
    place: "Place of calibration",
    own_premises: "the laboratory’s premises",
    replaces: "Replaces certificate",
    procedure: "Procedure",
    method_text: "Calibration on a precision centrifuge by the method of A. V. Kozlov (Lomonosov Moscow State \
        University): time means of the readings in several mounting positions, radii and speeds and at rest; joint \
        estimation of the instrument and of the geometry of the experiment by weighted least squares on the exact \
        model.",
    deviations: "Additions, deviations, exclusions",
    none: "none",
    conditions: "Conditions of calibration",
    temperature: "Air temperature",
    humidity: "Relative humidity",
    pressure: "Air pressure",
    traceability: "Metrological traceability",
    traceability_text: "The results are traceable to the SI through the standards below.",
    standard: "Standard",
    standard_certificate: "Certificate",
    traceable_to: "Traceable to",
    results: "Results",
    results_model: "Error model of the reading f′ of axis i at the specific force f:",
    uncertainty_statement: "The reported expanded uncertainty U is the standard uncertainty multiplied by the coverage \
        factor k for a coverage probability of approximately 95 % (95.45 %): k = 2 for a normal distribution; where the \
        effective degrees of freedom νeff are finite, that of Student’s distribution. It was evaluated in accordance with \
        JCGM 100 (GUM) and EA-4/02. 1 g = 9.80665 m/s².",
    adjustment: "Before and after adjustment",
    before_adjustment: "Before adjustment, ± U",
    after_adjustment: "After adjustment, ± U",
    no_adjustment: "The unit was not adjusted or repaired.",
    errors_of_readings: "Readings as received carry the error “before”; compensated with the parameters above they carry the \
        error “after”.",
    conformity: "Statement of conformity",
    specification: "Specification",
    decision_rule: "Decision rule",
    rule_simple: "simple acceptance: conformity is stated if the value lies within the limits; the risk of false \
        acceptance may reach 50 % (ILAC-G8)",
    rule_guarded: "guarded acceptance with guard band w = U: conformity is stated if the value lies within the \
        limits by U or more; risk of false acceptance below 2.5 % (ILAC-G8)",
    limits: "Limits",
    conforms: "conforms",
    does_not_conform: "does not conform",
    conformity_not_stated: "not stated",
    authorised: "Authorised by",
    responsible: "Persons responsible",
    signature: "signature",
    item_only: "The results relate only to the item calibrated, in the condition and at the time of calibration.",
    reproduction: "This certificate shall not be reproduced except in full without the approval of the laboratory.",
    end: "End of certificate",
    covariance_note: "The full covariance matrix of the parameters is in the digital calibration certificate and in \
        result.json.",
    mountings_used: "mountings",
    plateaus_used: "plateaus",
    uncertainty: "Expanded uncertainty",
    covariance: "Covariance matrix of the parameters",
    specific_force: "Specific force",
    unit_within: "Unit within its limits",
    unit_outside: "Unit not within its limits",
    unit_not_stated: "Unit: conformity not stated",
    unit_not_asked: "Unit: no limits given",
    unit_within_text: "Every limit below is kept by the decision rule.",
    unit_outside_text: "By the decision rule these limits are not kept:",
    unit_not_stated_text: "Nothing is stated from a calibration that is not acceptable, or of a parameter that the data do not \
        determine.",
    unit_not_asked_text: "The verdict on the left is on the calibration alone. Whether the unit meets a specification is \
        stated where the laboratory’s file gives limits.",
    limits_judged: "Limits judged",
    headline: "Reading error, root mean square",
    headline_note: "Over all plateaus of the calibrated range, against the specific force of the fitted geometry. The \
        compensated error is without what each plateau’s own speed explains, which along the arm is nearly \
        all of it; U is what the parameters leave in a compensated reading.",
    root_mean_square: "Root mean square",
    largest: "Largest magnitude",
    error_model: "Error model of the unit",
    error_model_note: "f′ is a reading in m/s², f the specific force along the sensitive axes:",
    parameters_of_instrument: "Parameters of the instrument",
    first_plots: "What the unit does and what is left",
    further_plots: "Further plots",
    checks: "Checks of the fit",
    contents: "Further, to be opened",
    effects_absent: "Effects whose absence is presupposed",
    counts_as_exact: "Counts as exact",
    nothing_exact: "nothing of what enters the model",
    all_rests_on: "Effects presupposed absent, in full",
    corrected_for: "corrected for the number of mountings,",
    f_test: "F test",
    coverage_and_degrees: "k (νeff)",
    unit_temperature: "Temperature of the unit",
    nominal_output: "Nominal conversion of the output",
    nominal_output_text: "Readings are f′ = (N − b)/S with the nominal scale S and the nominal bias b of the raw output N; \
        these are conventions, without uncertainty, and the parameters are corrections to them.",
    nominal_scale: "Nominal scale S",
    nominal_bias: "Nominal bias b",
    compensated_reading: "compensated reading, axis",
    at_plateau: "plateau",
    signed_on: "date",
    mark_place: "place for mark or seal",
    words: Words {
        group,
        meaning,
        source,
        method,
        termination,
        pair_relation,
        reference,
        rival,
        follows,
        speed_finding: speeds::in_english,
        speeds_measured: speeds::measured_in_english,
    },
    not_converged: "the fit did not converge",
    residuals_too_large: "residuals are larger than the stated uncertainties explain",
    degrees_of_freedom: "degrees of freedom",
    chance: "chance",
    left_out: "the model leaves out what the residuals show",
    left_out_alike: "the data cannot tell it from",
    explains: "explains",
    of_chi_squared: "of χ²",
    in_mounting: "mounting",
    rivals_tested: "Effects left out, of those tested",
    rests_on: "What the result rests on",
    rests_on_note: "Effects that the model leaves out. For each: the smallest size that this session would have shown with a \
        probability of 80 %, and what one of that size, not shown, does to the parameter of the instrument that it moves most \
        and to a compensated reading within the forces of the session. Where no size would show, the error is that of a \
        typical size.",
    rests_on_effect: "Effect",
    rests_on_size: "Smallest size shown",
    rests_on_moves: "Moves most",
    rests_on_reading: "Error of a compensated reading",
    not_shown: "not shown at any size",
    rests_on_sentence: "They presuppose that effects are absent of which this session would not have shown smaller sizes with a \
        probability of 80 %. The three that would do most harm",
    below: "below",
    would_not_show: "it would not show; that size moves",
    would_never_show: "it would not show at any size; a typical size moves",
    by: "by",
    uncertainties_and_reading: "standard uncertainties and a compensated reading by",
    presupposed: "The stated uncertainties presuppose a rigid arm, a constant temperature of the unit, and speeds whose errors \
        are independent from plateau to plateau.",
    chi_squared_small: "Residuals are smaller than the stated uncertainties allow: these are too large.",
    lost_parameters: "parameters of the instrument are not determined",
    speeds: "Speeds of the plateaus",
};

fn group(group: Group) -> &'static str {
    match group {
        Group::Bias => "Bias",
        Group::Scale => "Scale error",
        Group::Misalignment => "Misalignment",
        Group::Quadratic => "Quadratic",
        Group::Cubic => "Cubic",
        Group::CrossCoupling => "Cross-coupling",
        Group::Asymmetry => "Asymmetry of the scale",
        Group::HigherOrder => "Higher order",
        Group::Tilt => "Tilt of the rotation axis",
        Group::Turn => "Turn of the unit",
        Group::Shift => "Shift of the unit",
        Group::ProofMass => "Place of a proof mass",
        Group::ElasticTurn => "Elastic turn",
        Group::ArmStretch => "Stretch of the arm",
        Group::RadiusScale => "Scale of the radii",
        Group::SpeedScale => "Scale of the speed",
        Group::ArmTurn => "Elastic turn of the arm's end",
        Group::SpinTurn => "Turn of the unit while spinning",
        Group::Seat => "Place of a seat",
        Group::MountingShift => "Shift of one mounting",
        Group::MountingTurn => "Turn of one mounting",
        Group::MountingTilt => "Tilt of the axis in one mounting",
        Group::Disturbance => "Disturbance of the readings",
    }
}

fn meaning(of: Group) -> &'static str {
    match of {
        Group::Bias => "bias: reading at no specific force",
        Group::Scale => "scale error: relative error of the slope along the own axis",
        Group::Misalignment => "misalignment: part of a force along another axis that is read, an angle",
        Group::Quadratic => "quadratic coefficient: reading for the square of the force along axis j",
        Group::Cubic => "cubic coefficient along the own axis",
        Group::CrossCoupling => "cross-coupling: reading for the product of two forces",
        Group::Asymmetry => "asymmetry: scale that differs with the sign of the force",
        Group::HigherOrder => "coefficient of a higher power",
        _ => group(of),
    }
}

fn source(source: Source) -> &'static str {
    match source {
        Source::Noise => "Noise",
        Source::PlateauSpeed => "Speed of each plateau",
        Source::Priors => "Priors",
        Source::Gravity => "Gravity",
        Source::Latitude => "Latitude",
        Source::Radius => "Radius",
        Source::RadiusDifference => "Difference of radii",
        Source::SpeedScale => "Scale of the speed",
        Source::RestAngle => "Angle at rest",
        Source::ProofMasses => "Proof masses",
        Source::Attitude => "Attitudes",
        Source::Resolution => "Resolution",
        Source::Effects => "Effects left out",
    }
}

fn method(method: Method) -> &'static str {
    match method {
        Method::Exact => "exact, Gauss-Newton",
        Method::Recursive => "exact, recursive filter",
        Method::Linear => "linear [K5.3]",
    }
}

fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Linear => "linear",
        Termination::Converged => "converged",
        Termination::Stalled => "stalled",
        Termination::IterationLimit => "iteration limit",
    }
}

fn pair_relation(pair_relation: PairRelation) -> &'static str {
    match pair_relation {
        PairRelation::Common => "common",
        PairRelation::Opposite => "opposite",
        PairRelation::Free => "free",
    }
}

fn reference(reference: ReferencePoint) -> &'static str {
    match reference {
        ReferencePoint::FirstProofMass => "proof mass 1",
        ReferencePoint::OwnAxes => "no displacement along own axes",
    }
}

fn follows(follows: &Follows) -> &'static str {
    match follows {
        Follows::Position { .. } => "step in position",
        Follows::SpeedInPosition { .. } => "square of the speed in position",
        Follows::SpeedOnSeat { .. } => "square of the speed at radius",
        Follows::Speed => "square of the speed",
        Follows::Load => "load",
        Follows::Mounting { .. } => "step in mounting",
        Follows::Time => "drift over the session",
    }
}

fn rival(rival: Rival) -> &'static str {
    match rival {
        Rival::Terms(Extra::CrossProducts) => "products of two components of the force",
        Rival::Terms(Extra::OddQuadratic) => "odd square of the force",
        Rival::Terms(Extra::Asymmetry) => "scale that differs with the sign of the force",
        Rival::Terms(Extra::FourthPower) => "fourth power of the force",
        Rival::Terms(Extra::FifthPower) => "fifth power of the force",
        Rival::Terms(Extra::Jump) => "jump of the bias at zero force",
        Rival::Effect(extension) => match extension {
            Extension::ElasticTurn(Law::Speed) => {
                "elastic turn of the unit by position, growing with the square of the speed"
            }
            Extension::ElasticTurn(Law::Load) => "elastic turn of the unit by position, growing with the load",
            Extension::ArmStretch(Law::Speed) => "stretch of the arm with the square of the speed",
            Extension::ArmStretch(Law::Load) => "stretch of the arm with the load",
            Extension::SeatStretch(Law::Speed) => "stretch of the arm by seat with the square of the speed",
            Extension::SeatStretch(Law::Load) => "stretch of the arm by seat with the load",
            Extension::RadiusScale => "common scale of the radii",
            Extension::SpeedScale => "common scale of the speeds",
            Extension::ArmTurn(Law::Speed) => "turn of the arm's end with the square of the speed",
            Extension::ArmTurn(Law::Load) => "turn of the arm's end with the load: an arm that is not rigid",
            Extension::SeatRadius => "radius of a seat",
            Extension::SeatLateral => "lateral place of a seat",
            Extension::PositionShift => "shift of its own in each position: another relation of the pairs",
            Extension::MountingShift => "shift of its own in each mounting",
            Extension::MountingTurn => "turn of its own in each mounting",
            Extension::MountingTilt => "tilt of the axis that differs by mounting",
            Extension::SpinTurn => "turn of the unit between rest and spinning",
            Extension::Disturbance(Course::Spinning) => {
                "step between rest and spinning: an aliased line or rectified vibration"
            }
            Extension::Disturbance(Course::SquaredSpeed) => {
                "disturbance with the square of the speed: rectified vibration"
            }
            Extension::Disturbance(Course::Yield) => "proof mass that yields to its force",
            Extension::Disturbance(Course::Time) => "bias that changes over the session",
            Extension::Disturbance(Course::TimeScale) => "scale that changes over the session",
            Extension::Disturbance(Course::Rise) => "difference after a rise and after a fall of the speed",
            Extension::Disturbance(Course::Memory) => "memory of earlier forces",
            Extension::OneMounting(Difference::Shift, _) => "shift of the unit in one mounting",
            Extension::OneMounting(Difference::Turn, _) => "turn of the unit in one mounting",
            Extension::OneMounting(Difference::Unit, _) => "another unit in one mounting",
        },
    }
}
