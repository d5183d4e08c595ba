-- Collections of uploaded scenes. Jobs hold the ids of the scenes that a collection had when they were accepted.

CREATE TABLE collection_scenes (
    collection   TEXT NOT NULL,
    name         TEXT NOT NULL,              -- the order of the scenes in their collection
    scene_id     TEXT NOT NULL REFERENCES scenes (id),
    PRIMARY KEY (collection, name)           -- the same name again replaces the scene
) STRICT, WITHOUT ROWID;

-- A scene leaves its collections when it is deleted.
CREATE INDEX collection_scenes_by_scene ON collection_scenes (scene_id);
