//! Russian: words for what is one of several.

use centrical::{
    Course, Difference, Extension, Extra, Group, Law, PairRelation, ReferencePoint, Rival, Source, Termination,
};
use centrical_session::{AxesName, Follows, Method, NextAttitudeSummary, Redundancy};

pub(super) fn axes(name: &AxesName) -> String {
    match name {
        AxesName::LowerTriangular => "оси с нижнетреугольной матрицей передачи".to_owned(),
        AxesName::UpperTriangular => "оси с верхнетреугольной матрицей передачи".to_owned(),
        AxesName::Symmetric => "оси с симметричной матрицей передачи".to_owned(),
        AxesName::Case => "оси корпуса".to_owned(),
        AxesName::Other(name) => format!("оси «{name}»"),
    }
}

/// The form of the noun follows the last digits of a whole number; of a fraction it is the genitive.
pub(super) fn standard_uncertainties(number: &str) -> String {
    let noun = match number.as_bytes() {
        digits if digits.contains(&b',') => "стандартной неопределённости",
        [.., b'1', _] => "стандартных неопределённостей",
        [.., b'1'] => "стандартную неопределённость",
        [.., b'2'..=b'4'] => "стандартные неопределённости",
        _ => "стандартных неопределённостей",
    };
    format!("{number} {noun}")
}

pub(super) fn group(group: Group) -> &'static str {
    match group {
        Group::Bias => "Смещение нуля",
        Group::Scale => "Погрешность масштаба",
        Group::Misalignment => "Перекос оси",
        Group::Quadratic => "Квадратичный член",
        Group::Cubic => "Кубичный член",
        Group::CrossCoupling => "Перекрёстная связь",
        Group::Asymmetry => "Асимметрия масштаба",
        Group::HigherOrder => "Член высшего порядка",
        Group::Tilt => "Наклон оси вращения",
        Group::Turn => "Поворот прибора",
        Group::Shift => "Смещение прибора",
        Group::Attitude => "Наклон в покое",
        Group::CaseTurn => "Поворот прибора относительно корпуса",
        Group::ProofMass => "Положение чувствительной массы",
        Group::ElasticTurn => "Упругий поворот",
        Group::ArmStretch => "Растяжение плеча",
        Group::RadiusScale => "Масштаб радиусов",
        Group::SpeedScale => "Масштаб скорости",
        Group::SpeedOffset => "Сдвиг скорости",
        Group::EarthRate => "Вращение Земли",
        Group::Gravity => "Ошибка ускорения свободного падения",
        Group::ArmTurn => "Упругий поворот конца плеча",
        Group::SpinTurn => "Поворот прибора при вращении",
        Group::Seat => "Положение посадочного места",
        Group::MountingShift => "Смещение в одной установке",
        Group::MountingTurn => "Поворот в одной установке",
        Group::MountingTilt => "Наклон оси в одной установке",
        Group::AngleTilt => "Наклон оси при одном угле покоя",
        Group::MountingBias => "Смещение нуля в одной установке",
        Group::MountingScale => "Масштаб в одной установке",
        Group::Disturbance => "Возмущение показаний",
    }
}

pub(super) fn meaning(of: Group) -> &'static str {
    match of {
        Group::Bias => "смещение нуля: показание без удельной силы",
        Group::Scale => "погрешность масштабного коэффициента: относительная погрешность наклона по собственной оси",
        Group::Misalignment => "перекос: доля силы вдоль другой оси, попадающая в показание, угол",
        Group::Quadratic => "квадратичный коэффициент: показание от квадрата силы вдоль оси j",
        Group::Cubic => "кубичный коэффициент по собственной оси",
        Group::CrossCoupling => "перекрёстная связь: показание от произведения двух сил",
        Group::Asymmetry => "асимметрия: масштаб, зависящий от знака силы",
        Group::HigherOrder => "коэффициент при высшей степени",
        _ => group(of),
    }
}

pub(super) fn source(source: Source) -> &'static str {
    match source {
        Source::Noise => "Шум",
        Source::PlateauSpeed => "Скорость каждой площадки",
        Source::Priors => "Априорные данные",
        Source::Gravity => "Ускорение силы тяжести",
        Source::Latitude => "Широта",
        Source::Radius => "Радиус",
        Source::RadiusDifference => "Разность радиусов",
        Source::SpeedScale => "Масштаб скорости",
        Source::RestAngle => "Угол в покое",
        Source::ProofMasses => "Чувствительные массы",
        Source::Attitude => "Ориентация",
        Source::BiasChange => "Изменение смещения при выключении",
        Source::Turning => "Ускорение относительно осей медленного вращения",
        Source::Resolution => "Разрешение",
        Source::Effects => "Неучтённые эффекты",
    }
}

pub(super) fn method(method: Method) -> &'static str {
    match method {
        Method::Exact => "точная модель, метод Гаусса — Ньютона",
        Method::Recursive => "точная модель, рекуррентный фильтр",
        Method::Linear => "линейная модель [K5.3]",
        Method::RecursiveLinear => "линейная модель [K5.3], рекуррентный фильтр",
    }
}

pub(super) fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Linear => "линейная модель",
        Termination::Converged => "сошлось",
        Termination::Stalled => "остановилось",
        Termination::IterationLimit => "предел итераций",
    }
}

pub(super) fn pair_relation(pair_relation: PairRelation) -> &'static str {
    match pair_relation {
        PairRelation::Common => "общая",
        PairRelation::Opposite => "противоположная",
        PairRelation::Free => "независимая",
    }
}

pub(super) fn reference(reference: ReferencePoint) -> &'static str {
    match reference {
        ReferencePoint::FirstProofMass => "чувствительная масса 1",
        ReferencePoint::OwnAxes => "без смещений вдоль собственных осей",
    }
}

pub(super) fn follows(follows: &Follows) -> &'static str {
    match follows {
        Follows::Position { .. } => "скачок в положении",
        Follows::SpeedInPosition { .. } => "квадрат скорости в положении",
        Follows::SpeedOnSeat { .. } => "квадрат скорости на радиусе",
        Follows::Speed => "квадрат скорости",
        Follows::Load => "нагрузка",
        Follows::Mounting { .. } => "скачок в установке",
        Follows::Time => "уход",
    }
}

pub(super) fn rival(rival: Rival) -> &'static str {
    match rival {
        Rival::Terms(Extra::CrossProducts) => "произведения двух составляющих силы",
        Rival::Terms(Extra::CrossCubes) => "кубы других составляющих силы",
        Rival::Terms(Extra::CubicProducts) => "произведения трёх составляющих силы",
        Rival::Terms(Extra::OddQuadratic) => "квадрат силы со знаком, f·|f|",
        Rival::Terms(Extra::Asymmetry) => "масштаб, зависящий от знака силы",
        Rival::Terms(Extra::FourthPower) => "четвёртая степень силы",
        Rival::Terms(Extra::FifthPower) => "пятая степень силы",
        Rival::Terms(Extra::OwnSquares) => "квадрат силы",
        Rival::Terms(Extra::CrossSquares) => "квадраты других составляющих силы",
        Rival::Terms(Extra::OwnCubes) => "куб силы",
        Rival::Terms(Extra::Jump) => "скачок нуля при смене знака силы",
        Rival::Effect(extension) => match extension {
            Extension::ElasticTurn(Law::Speed) => {
                "упругий поворот прибора по положениям, растущий с квадратом скорости"
            }
            Extension::ElasticTurn(Law::Load) => "упругий поворот прибора по положениям, растущий с нагрузкой",
            Extension::ArmStretch(Law::Speed) => "растяжение плеча с квадратом скорости",
            Extension::ArmStretch(Law::Load) => "растяжение плеча с нагрузкой",
            Extension::SeatStretch(Law::Speed) => "растяжение плеча по местам с квадратом скорости",
            Extension::SeatStretch(Law::Load) => "растяжение плеча по местам с нагрузкой",
            Extension::RadiusScale => "общий масштаб радиусов",
            Extension::SpeedScale => "общий масштаб скоростей",
            Extension::SpeedOffset => "общий сдвиг скоростей",
            Extension::EarthRate => "вращение Земли: широта не задана",
            Extension::Gravity => "ускорение свободного падения отличается от заданного",
            Extension::ArmTurn(Law::Speed) => "поворот конца плеча с квадратом скорости",
            Extension::ArmTurn(Law::Load) => "поворот конца плеча с нагрузкой: нежёсткое плечо",
            Extension::SeatRadius => "радиус посадочного места",
            Extension::SeatLateral => "боковое положение посадочного места",
            Extension::PositionShift => "собственное смещение в каждом положении: иное соотношение пар",
            Extension::MountingShift => "собственное смещение в каждой установке",
            Extension::MountingTurn => "собственный поворот в каждой установке",
            Extension::MountingTilt => "наклон оси, различный по установкам",
            Extension::AngleTilt => "наклон оси, различный по углам покоя, или угол, отличный от заданного",
            Extension::MountingBias => "смещение нуля, различное по установкам",
            Extension::MountingScale => "масштаб, различный по установкам",
            Extension::RestsBias => {
                "смещение нуля в положениях покоя [[tumble]], отличное более чем на bias_change: другое включение"
            }
            Extension::RestsScale => {
                "масштаб в положениях покоя [[tumble]], отличный от масштаба на центрифуге: другая температура или сила тяжести"
            }
            Extension::RestsUnit => "другой прибор или другой порядок осей в положениях покоя [[tumble]]",
            Extension::AttitudesTilt => {
                "заданные ориентации, ошибки которых больше заявленных и одинаковы во всех положениях покоя с этой ориентацией"
            }
            Extension::RestsTilt => "ориентации в покое, ошибки которых больше заявленных",
            Extension::SpinTurn => "поворот прибора между покоем и вращением",
            Extension::Disturbance(Course::Spinning) => {
                "ступень между покоем и вращением: наложение частот или выпрямленная вибрация"
            }
            Extension::ProofMasses => "координаты чувствительных масс, принятые за точные",
            Extension::Disturbance(Course::Speed) => "возмущение со скоростью: выпрямленная вибрация",
            Extension::Disturbance(Course::SquaredSpeed) => "возмущение с квадратом скорости: выпрямленная вибрация",
            Extension::Disturbance(Course::FourthPowerOfSpeed) => {
                "возмущение с четвёртой степенью скорости: выпрямленная вибрация дисбаланса"
            }
            Extension::Disturbance(Course::OwnRate) => "возмущение с угловой скоростью вокруг собственной оси",
            Extension::Disturbance(Course::Yield) => "чувствительная масса, податливая силе",
            Extension::Disturbance(Course::Time) => "изменение нуля за время эксперимента",
            Extension::Disturbance(Course::TimeScale) => "изменение масштаба за время эксперимента",
            Extension::Disturbance(Course::WarmUp) => "прогрев: изменение нуля от начала каждой установки",
            Extension::Disturbance(Course::WarmUpScale) => "прогрев: изменение масштаба от начала каждой установки",
            Extension::Disturbance(Course::Heat(Law::Speed)) => {
                "изменение нуля с теплом, накопленным в установке, по скорости"
            }
            Extension::Disturbance(Course::Heat(Law::Load)) => {
                "изменение нуля с теплом, накопленным в установке, по нагрузке"
            }
            Extension::Resonance(_) | Extension::Disturbance(Course::AtSpeedOf(_)) => {
                "возмущение на одной заданной скорости: вибрация в резонансе"
            }
            Extension::Disturbance(Course::Rise) => "различие после роста и после спада скорости",
            Extension::Disturbance(Course::Memory) => "память о прежних силах",
            Extension::Disturbance(Course::Turn) => "гистерезис: нуль по знаку последнего изменения силы",
            Extension::BiasWander | Extension::Disturbance(Course::Wander(_)) => {
                "плавное изменение нуля за время эксперимента: прогрев или медленная волна"
            }
            Extension::Disturbance(Course::From(_)) => "скачок нуля перед положением покоя",
            Extension::OneSpeed(_) => "ошибка одной заданной скорости",
            Extension::OneMounting(Difference::Shift, _) => "смещение прибора в одной установке",
            Extension::OneMounting(Difference::Turn, _) => "поворот прибора в одной установке",
            Extension::OneMounting(Difference::Unit, _) => "другой прибор в одной установке",
        },
    }
}

/// Words in the formulas of rivals.
const OF_FORMULAS: [(&str, &str); 19] = [
    ("by position", "по положениям"),
    ("by seat", "по посадочным местам"),
    ("by mounting", "по установкам"),
    ("by angle of rest", "по углам покоя"),
    ("by switch-on of rests", "по включениям в покое"),
    ("by stated attitude", "по заданным ориентациям"),
    ("by rest", "по положениям покоя"),
    ("from one rest on", "начиная с одного положения покоя"),
    ("while spinning", "при вращении"),
    ("those taken as exact", "принятые за точные"),
    ("where", "при"),
    ("over plateaus of the mounting", "по площадкам установки"),
    ("on plateau n of a mounting", "на площадке n установки"),
    ("after a rise of", "после роста"),
    ("after a fall", "после спада"),
    ("n plateaus before", "n площадок назад"),
    ("at one set speed", "при одной заданной скорости"),
    ("in one mounting", "в одной установке"),
    ("rpm", "об/мин"),
];

/// A formula of a rival. Of one set speed it has the value, the only number with a point: `d f / d ln Omega^2 at 378.40 rpm`.
pub(super) fn formula(formula: &str) -> String {
    let worded = OF_FORMULAS.iter().fold(formula.to_owned(), |text, (english, russian)| text.replace(english, russian));
    worded.replace(" at ", " при ").replace('.', ",")
}

/// The scatter from rest to rest and the drift of the biases that the uncertainties include.
pub(super) fn between_rests(scatter: &str, drift: &str) -> String {
    format!(
        "В них учтено то, чего не исключают невязки: разброс {scatter} от одного положения покоя к другому и уход смещений нуля на {drift}."
    )
}

/// Arcs of slow rotation that count as rests.
pub(super) fn turning(arcs: usize, share: &str, [rate, radius, acceleration]: [&str; 3]) -> String {
    format!(
        "Из положений покоя {arcs} — отрезки медленного вращения со скоростью не более {rate}; на них приходится {share} % веса. На расстоянии {radius} от осей вращения чувствительные массы ускоряются вдоль вертикали; неопределённость этого ускорения на отрезке не более {acceleration}."
    )
}

/// What no redundant reading checks.
pub(super) fn not_checked(redundancy: Redundancy) -> Option<String> {
    match redundancy {
        Redundancy::Everywhere => None,
        Redundancy::ButFor(parameters) => {
            Some(format!("Для {} избыточных показаний нет: проверить найденные значения нечем.", parameters.join(", ")))
        }
        Redundancy::Nowhere => {
            Some("Избыточных показаний нет: заявленные неопределённости ничем не проверены.".to_owned())
        }
    }
}

/// How many attitudes of all rests are known, and to what standard uncertainty at most.
pub(super) fn known_attitudes(known: usize, all: usize, uncertainty: &str) -> String {
    match known {
        0 => "Ориентации заранее не известны.".to_owned(),
        _ => format!("Из {all} ориентаций известны {known}, со стандартной неопределённостью не более {uncertainty}."),
    }
}

pub(super) fn next_rest(next: &NextAttitudeSummary) -> String {
    let along = |sign: f64, way: &str| {
        let axes: Vec<String> = (1..=3).filter(|i| next.up[i - 1] * sign > 0.1).map(|i| i.to_string()).collect();
        (!axes.is_empty()).then(|| format!("{} {} {way}", if axes.len() > 1 { "оси" } else { "ось" }, axes.join(", ")))
    };
    let axes: Vec<String> = [along(1.0, "вверх"), along(-1.0, "вниз")].into_iter().flatten().collect();
    let brings = match (&next.parameter, next.parameter_factor) {
        (Some(parameter), Some(factor)) if next.gain == 0 => {
            let comma = |number: f64| format!("{number:.2}").replace('.', ",");
            format!(
                "неопределённости составят {} нынешних в среднем, для {parameter} — {}",
                comma(next.factor),
                comma(factor)
            )
        }
        _ => format!("вернёт потерянных комбинаций: {}", next.gain),
    };
    format!("Следующее положение покоя: {}; {brings}.", axes.join(", "))
}

#[cfg(test)]
mod tests {
    use centrical::{Course, Difference, Extension, Rival};

    use super::{formula, standard_uncertainties};

    /// Letters and functions of formulas.
    const SYMBOLS: &str = "Omega omega delta kappa tau alpha theta rho Gamma sgn ln sum";

    #[test]
    fn the_noun_agrees_with_the_last_digits() {
        let shown = ["1", "21", "22", "104", "11", "112", "25", "110", "2,4", "0,21"].map(standard_uncertainties);
        let nouns = shown.map(|text| text.split_once(' ').unwrap().1.replace("неопределённост", ""));
        let [one, few, many, part] = ["стандартную ь", "стандартные и", "стандартных ей", "стандартной и"];
        assert_eq!(nouns, [one, one, few, few, many, many, many, many, part, part]);
    }

    #[test]
    fn formulas_have_no_english_words() {
        let single = [
            Extension::OneSpeed(0),
            Extension::Resonance(0),
            Extension::Disturbance(Course::From(1)),
            Extension::OneMounting(Difference::Shift, 0),
            Extension::OneMounting(Difference::Turn, 0),
            Extension::OneMounting(Difference::Unit, 0),
        ];
        for rival in Rival::COMMON.into_iter().chain(single.map(Rival::Effect)) {
            let russian = formula(rival.formula());
            let words =
                russian.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| word.len() > 2 || *word == "by");
            for word in words {
                assert!(SYMBOLS.split(' ').any(|symbol| symbol == word), "{word} of {russian}");
            }
        }
        assert_eq!(formula("d f / d ln Omega^2 at 378.40 rpm"), "d f / d ln Omega^2 при 378,40 об/мин");
        assert_eq!(formula("df0, by switch-on of rests"), "df0, по включениям в покое");
    }
}
