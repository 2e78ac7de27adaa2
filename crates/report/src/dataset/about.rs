//! What a dataset is, in words.

use sweep::reader::{Dataset, Sensors};

/// What the dataset is, in a sentence or two.
pub(super) fn dataset(dataset: &Dataset) -> String {
    let (machine, counts) = (&dataset.plan.base.name, &dataset.manifest().counts);
    let failed = match counts.failed {
        0 => String::new(),
        n => format!(" ({n} failed)"),
    };
    let effects = match dataset.plan.effects.is_empty() {
        true => "",
        false => " and the effects that vary",
    };
    let mut about = format!(
        "Simulated recordings of the {machine}, labelled with the clearance of its joints{effects}: {}{failed}, {} of the crank \
         each.",
        text::counted(counts.cases as usize, "case"),
        text::counted(dataset.plan.settings.revolutions as usize, "revolution"),
    );
    if dataset.has_signals() {
        about += &format!(" {}", sensors(&dataset.sensors));
        if !dataset.has_crank_angle() {
            about +=
                " No sensor reads the crank angle: it is counted from the start of each window.";
        }
    } else {
        about += &format!(" {}", no_recordings(dataset));
    }
    about
}

/// Why the page shows no recording; empty where it does.
pub(super) fn no_recordings(dataset: &Dataset) -> &'static str {
    if dataset.has_signals() {
        ""
    } else if dataset.sensors.is_empty() {
        "No sensor of this dataset measures an acceleration."
    } else if dataset.is_in_mcap() {
        "The recordings of this dataset are MCAP files, one per case, for Foxglove and the like; this page is made \
         from the features alone."
    } else {
        "No case has a recording."
    }
}

/// Which channel shows what, in a sentence or two.
fn sensors(sensors: &Sensors) -> String {
    match sensors.channels() {
        [] => String::new(),
        [channel] => format!("Figures show the channel {channel}_m_s2, as the sensor reads it."),
        _ => {
            let throws = sensors.throws();
            let each: Vec<String> = throws
                .map(|(throw, channel)| format!("{throw}: {channel}_m_s2"))
                .collect();
            format!(
                "A fault is judged by the sensor of its own throw ({}), as the sensor reads it.",
                each.join("; ")
            )
        }
    }
}
