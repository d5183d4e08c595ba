-- What the objects of an uploaded scene's instance mask are.

ALTER TABLE scenes ADD COLUMN classes TEXT;  -- JSON with categories and segments_info, as COCO's panoptic annotations
