//! Who delivered an image, if the service does not trust its worker.

use sqlx::sqlite::SqliteConnection;

use crate::error::CatalogueError;
use crate::types::Delivery;

/// Stores the delivery of a new image.
pub(crate) async fn insert_delivery(
    connection: &mut SqliteConnection,
    job: &str,
    frame: i64,
    delivery: &Delivery,
) -> Result<(), CatalogueError> {
    sqlx::query(
        "INSERT OR REPLACE INTO deliveries (job_id, frame, worker, place, due, covers)
         SELECT id, ?2, ?3, ?4, ?5, CASE WHEN distrusted = 1 THEN 0 ELSE ?4 END FROM jobs WHERE id = ?1",
    )
    .bind(job)
    .bind(frame)
    .bind(&delivery.worker)
    .bind(delivery.place as i64)
    .bind(delivery.is_due)
    .execute(connection)
    .await?;
    Ok(())
}
