//! Dates in one column and times of the day in another, as one column of stamps.

use super::columnar::{Column, MISSING, Parts};
use crate::column::{ColumnName, Field, Rule};
use crate::error::Error;
use crate::stamp::{TickForm, TickUnit};

/// Seconds of a day, as dates count them.
pub(super) const SECONDS_OF_DAY: i64 = 86_400;

/// How the stamps are counted.
const FORM: TickForm = TickForm { unit: TickUnit::Nanosecond, is_utc: false };

/// What `open` reads of `fields`; in place of one of a date and a time of the day it is asked for both.
pub(super) fn joined(fields: &[Field], open: impl FnOnce(&[Field]) -> Result<Parts, Error>) -> Result<Parts, Error> {
    let Some(place) = fields.iter().position(|field| field.name.date_and_column().0.is_some()) else {
        return open(fields);
    };
    let (date, time) = fields[place].name.date_and_column();
    let part =
        |name: &ColumnName, rule, expected: &str| Field { name: name.clone(), rule, expected: expected.to_owned() };
    let dates = date.map(|date| part(date, Rule::Date, "dates"));
    let times = part(time, Rule::TimeOfDay, "times of the day");
    let mut in_file = fields.to_vec();
    drop(in_file.splice(place..=place, dates.into_iter().chain([times])));
    let parts = open(&in_file)?;
    Ok(Box::new(parts.map(move |columns| {
        let mut columns = columns?;
        let time = columns.remove(place + 1);
        let date = columns.remove(place);
        columns.insert(place, stamps(date, time));
        Ok(columns)
    })))
}

/// The stamps of dates and times of the day.
fn stamps(mut date: Column, mut time: Column) -> Column {
    let [of_date, of_time] = [&date, &time].map(|column| match column {
        Column::Stamps(form, _) => form.unit.nanoseconds(),
        Column::Numbers(_) => TickUnit::Second.nanoseconds(),
    });
    Column::Stamps(
        FORM,
        Box::new(move |values, ticks| {
            let [mut days, mut times] = <[(Vec<f64>, Vec<i64>); 2]>::default();
            date.read(&mut days.0, &mut days.1)?;
            time.read(&mut times.0, &mut times.1)?;
            let count = days.0.len().max(times.0.len());
            let seconds = |row: usize| Some(days.0.get(row)? + times.0.get(row)?).filter(|seconds| !seconds.is_nan());
            values.extend((0..count).map(|row| seconds(row).unwrap_or(MISSING)));
            // A row without a value has no ticks, and the rows of the other ticks are then unknown.
            if [&days.1, &times.1].iter().all(|ticks| ticks.len() == count) {
                let instant =
                    |(day, time): (&i64, &i64)| day.checked_mul(of_date)?.checked_add(time.checked_mul(of_time)?);
                ticks.extend(days.1.iter().zip(&times.1).filter_map(instant));
            }
            Ok(())
        }),
    )
}
