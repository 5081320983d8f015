//! What a comparison of results says, in each language.

use centrical_session::unit_name;

use crate::number::counted;

/// What a comparison says, in one language. Numbers in sentences are written already.
#[allow(missing_docs)]
pub(crate) struct ComparisonMessages {
    pub agree: [&'static str; 2],
    pub agree_of_same_files: &'static str,
    pub disagree: [&'static str; 2],
    pub other_units: [&'static str; 2],
    pub heading: [&'static str; 2],
    pub not_acceptable: &'static str,
    /// The second result less the first, with the years between them.
    pub less: fn(usize, usize, Option<&str>) -> String,
    pub same_files: &'static str,
    /// How many files.
    pub same_files_text: fn(usize) -> String,
    /// How many of how many coefficients differ by more than the expanded uncertainty.
    pub beyond: fn(usize, usize) -> String,
    /// How many coefficients, their chi^2 and its probability.
    pub together: fn(usize, &str, &str) -> String,
    pub unit: &'static str,
    pub difference: &'static str,
    pub per_year: &'static str,
    pub disagrees: &'static str,
    pub different_units: &'static str,
    /// The units of the first result and of the second.
    pub different_units_text: fn(&str, &str) -> String,
    pub different_models: &'static str,
    /// Coefficients that the first result alone has, and the second alone.
    pub only_in: [fn(&str) -> String; 2],
    pub not_compared: &'static str,
    /// Coefficients that priors alone determine.
    pub by_priors_alone: fn(&str) -> String,
    pub nothing: [&'static str; 2],
    /// A unit by its model and serial number.
    pub unit_name: fn(&str, &str) -> String,
    pub position: &'static str,
    pub pair: &'static str,
    pub or: &'static str,
    pub plot: &'static str,
    pub plot_axis: &'static str,
    /// The second result less the first.
    pub plot_less: fn(usize, usize) -> String,
}

/// In English.
pub(super) const IN_ENGLISH: ComparisonMessages = ComparisonMessages {
    agree: ["AGREE", "no difference beyond what the uncertainties explain"],
    agree_of_same_files: "no difference beyond what the uncertainties explain, which two results of the same files show anyway",
    disagree: ["DO NOT AGREE", "the reasons stand below"],
    other_units: ["OTHER UNITS", "the results are of different units; their differences stand below"],
    heading: ["COMPARISON", "difference ± standard uncertainty; E_n with expanded uncertainties, k = 2"],
    not_acceptable: "NOT ACCEPTABLE",
    less: |second, first, years| {
        let years = years.map_or(String::new(), |years| format!(", {years} years between them"));
        format!("RESULT {second} LESS RESULT {first}{years}")
    },
    same_files: "SAME FILES",
    same_files_text: |count| {
        format!("both rest on {} with the same bytes: one measurement, not two", counted(count, "file"))
    },
    beyond: |beyond, count| {
        format!("{beyond} of {count} have E_n beyond 1; by chance it is 1 in 20, and a DISAGREE in 1 of 100 pairs")
    },
    together: |count, chi_squared, chance| {
        format!(
            "all {count} together: chi^2 = {chi_squared} with {count} degrees of freedom, probability {chance} if nothing has \
             changed"
        )
    },
    unit: "unit",
    difference: "difference",
    per_year: "per year",
    disagrees: "DISAGREE",
    different_units: "DIFFERENT UNITS",
    different_units_text: |first, second| format!("the first result is of {first}, the second of {second}"),
    different_models: "DIFFERENT ERROR MODELS",
    only_in: [
        |terms| format!("only the first has {terms}: other coefficients may differ for that"),
        |terms| format!("only the second has {terms}: other coefficients may differ for that"),
    ],
    not_compared: "NOT COMPARED",
    by_priors_alone: |names| format!("priors alone determine {names}: they show no change"),
    nothing: ["NOTHING TO COMPARE", "the two determine no coefficient in common"],
    unit_name,
    position: "delta[n]: of position n",
    pair: "dR[A]: of the pair A of positions",
    or: " or ",
    plot: "Differences over expanded uncertainties",
    plot_axis: "coefficient, in the order of the table",
    plot_less: |second, first| format!("{second} less {first}"),
};

/// In Russian.
pub(super) const IN_RUSSIAN: ComparisonMessages = ComparisonMessages {
    agree: ["СОГЛАСУЮТСЯ", "разности не больше, чем объясняют неопределённости"],
    agree_of_same_files: "разности не больше, чем объясняют неопределённости, но для двух результатов по одним и тем же файлам это так всегда",
    disagree: ["НЕ СОГЛАСУЮТСЯ", "причины указаны ниже"],
    other_units: ["РАЗНЫЕ ПРИБОРЫ", "результаты относятся к разным приборам; их разности приведены ниже"],
    heading: ["СРАВНЕНИЕ", "разность ± стандартная неопределённость; E_n — по расширенным неопределённостям, k = 2"],
    not_acceptable: "НЕ ПРИНЯТ",
    less: |second, first, years| {
        let years = years.map_or(String::new(), |years| format!(", лет между ними: {years}"));
        format!("РЕЗУЛЬТАТ {second} МИНУС РЕЗУЛЬТАТ {first}{years}")
    },
    same_files: "ОДНИ И ТЕ ЖЕ ФАЙЛЫ",
    same_files_text: |count| {
        format!("файлов с одинаковым содержимым в основе обоих результатов: {count}; это одно измерение, а не два")
    },
    beyond: |beyond, count| {
        format!(
            "E_n по модулю больше 1: {beyond} из {count}; случайно так бывает в 1 случае из 20, а расхождение — в 1 из 100 пар"
        )
    },
    together: |count, chi_squared, chance| {
        format!(
            "все вместе: χ² = {chi_squared}, степеней свободы {count}; вероятность столь большого при отсутствии изменений: {chance}"
        )
    },
    unit: "единица",
    difference: "разность",
    per_year: "за год",
    disagrees: "РАСХОЖДЕНИЕ",
    different_units: "РАЗНЫЕ ПРИБОРЫ",
    different_units_text: |first, second| format!("первый результат — {first}, второй — {second}"),
    different_models: "РАЗНЫЕ МОДЕЛИ ПОГРЕШНОСТЕЙ",
    only_in: [
        |terms| format!("только в первом: {terms}; другие коэффициенты могут отличаться из-за этого"),
        |terms| format!("только во втором: {terms}; другие коэффициенты могут отличаться из-за этого"),
    ],
    not_compared: "НЕ СРАВНИВАЮТСЯ",
    by_priors_alone: |names| format!("определены одними априорными данными и изменений не показывают: {names}"),
    nothing: ["СРАВНИВАТЬ НЕЧЕГО", "общих коэффициентов, определённых в обоих результатах, нет"],
    unit_name: |model, serial| match (model, serial) {
        ("", "") => "прибор без названия".to_owned(),
        (model, "") => format!("{model}, заводской номер не указан"),
        ("", serial) => format!("заводской № {serial}"),
        (model, serial) => format!("{model}, заводской № {serial}"),
    },
    position: "delta[n]: в положении n",
    pair: "dR[A]: в паре положений A",
    or: " или ",
    plot: "Нормированные разности E_n",
    plot_axis: "коэффициент, в порядке таблицы",
    plot_less: |second, first| format!("{second} минус {first}"),
};
