//! Starts, awaits and cancels trainings of styles.

use std::sync::Arc;
use std::time::Duration;

use style::ModelCard;

use super::Styles;
use super::trainings::{Order, Progress, Training};
use crate::http::problem::Problem;
use crate::limits;

impl Styles {
    /// Validates the photos of an order and accepts it. The training continues if the caller disconnects.
    pub(super) async fn train(self: &Arc<Self>, order: Order) -> Result<Arc<Training>, Problem> {
        self.trainings.validate(&order).await?;
        let known = self.known();
        let training = self
            .trainings
            .accept(order, &known.library, self.stop.child_token())?;
        let (styles, work) = (Arc::clone(self), Arc::clone(&training));
        tokio::spawn(async move {
            let state = tokio::select! {
                () = work.stop.cancelled() => Progress::Cancelled,
                ended = styles.train_and_add(&work.order) => match ended {
                    Ok(card) => Progress::Done(Box::new(card)),
                    Err(why) => Progress::Failed(why),
                },
            };
            work.end(state);
        });
        Ok(training)
    }

    async fn train_and_add(self: &Arc<Self>, order: &Order) -> Result<ModelCard, String> {
        let new = self.trainings.train(order).await?;
        let (card, _) = self.add(new).await.map_err(|problem| problem.to_string())?;
        Ok(card)
    }

    /// Waits until a training has ended, the limit is over, or the service stops.
    pub(super) async fn wait(&self, training: &Training, limit: Duration) {
        let mut ended = std::pin::pin!(training.ended.notified());
        ended.as_mut().enable();
        if training.is_open() {
            tokio::select! {
                _ = tokio::time::timeout(limit, ended) => {}
                () = self.stop.cancelled() => {}
            }
        }
    }

    /// Cancels a training and deletes its results. A training that has ended is unchanged.
    pub(super) async fn cancel(&self, id: &str) -> Result<Arc<Training>, Problem> {
        let training = self.trainings.get(id)?;
        training.stop.cancel();
        self.wait(&training, limits::REQUEST).await;
        Ok(training)
    }
}
