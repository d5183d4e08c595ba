-- Where the camera of an uploaded scene was.

ALTER TABLE scenes ADD COLUMN world_from_camera TEXT;  -- JSON: the matrix by rows
