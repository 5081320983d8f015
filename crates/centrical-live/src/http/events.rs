//! The panel as server-sent events: every viewer gets the newest, a slow one skips those between.

use std::sync::Arc;
use std::time::{Duration, Instant};

use centrical_report::Language;
use tokio::sync::watch::{Receiver, Sender, channel};
use tokio::time::sleep;

use crate::site::Site;

/// Time between two looks at the files.
const LOOK_EACH: Duration = Duration::from_millis(500);

/// Longest time without an event: ages grow though no file changes.
const SEND_EACH: Duration = Duration::from_secs(5);

/// The newest panel in each language, as an event.
#[derive(Debug, Clone)]
pub struct Events {
    panels: [(Language, Sender<Arc<str>>); 2],
}

impl Default for Events {
    fn default() -> Self {
        let panel = || channel(Arc::from("")).0;
        Self { panels: [(Language::English, panel()), (Language::Russian, panel())] }
    }
}

impl Events {
    /// The events of a language; the newest one comes at once.
    pub fn subscribe(&self, language: Language) -> Receiver<Arc<str>> {
        let known = self.panels.iter().find(|(known, _)| *known == language);
        known.unwrap_or(&self.panels[0]).1.subscribe()
    }
}

/// Sends the panels of `site` as they change. Languages without a viewer are not drawn.
pub async fn follow<S: Site>(site: Arc<S>, events: Events) {
    if !site.has_panel() {
        return;
    }
    let mut sent = [(None, 0, Instant::now()); 2];
    loop {
        let stamp = site.stamp();
        for ((language, sender), (last, viewers, at)) in events.panels.iter().zip(&mut sent) {
            let now = sender.receiver_count();
            let is_due = *last != Some(stamp) || now > *viewers || at.elapsed() >= SEND_EACH;
            if now > 0 && is_due {
                let (site, language) = (Arc::clone(&site), *language);
                if let Ok(Some(panel)) = tokio::task::spawn_blocking(move || site.panel(language)).await {
                    sender.send_replace(Arc::from(event(&panel)));
                }
                (*last, *at) = (Some(stamp), Instant::now());
            }
            *viewers = now;
        }
        sleep(LOOK_EACH).await;
    }
}

/// A text as an event.
fn event(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(|line| format!("data: {line}\n")).collect();
    format!("retry: 1000\n{}\n", lines.concat())
}
