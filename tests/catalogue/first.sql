-- A catalogue as the first version of the program left it: one job under way, one that ended with failures, a scene.
-- Tables stand in the order of their names, so keys that point ahead are not checked while they are filled.
PRAGMA foreign_keys = OFF;
BEGIN TRANSACTION;
CREATE TABLE _sqlx_migrations (
    version BIGINT PRIMARY KEY,
    description TEXT NOT NULL,
    installed_on TIMESTAMP NOT NULL DEFAULT CURRENT_TIMESTAMP,
    success BOOLEAN NOT NULL,
    checksum BLOB NOT NULL,
    execution_time BIGINT NOT NULL
);
INSERT INTO "_sqlx_migrations" VALUES(1,'catalogue','2025-01-02 03:04:05',1,X'9F9F3CC3C55EA4FFEF7693F120A38321142DE04EC777191580CFAAC81D63FDDD32A616DF523CD892C2635D7C9E9883E8',1000);
CREATE TABLE artifacts (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    kind         TEXT NOT NULL,
    digest       TEXT NOT NULL,
    bytes        INTEGER NOT NULL,
    media_type   TEXT NOT NULL,
    PRIMARY KEY (job_id, frame, kind)
) STRICT, WITHOUT ROWID;
INSERT INTO "artifacts" VALUES('job_old',0,'range','c17bfe9bfaf5969f24d234e7706ca06b208fa305cae1c79140f58b016b7009d0',345679,'image/png');
INSERT INTO "artifacts" VALUES('job_old',0,'rgb','05c811324a03872f665c37d4afdf00d308b1d7d46a3613f428f2efe3c5d8f649',355700,'image/png');
INSERT INTO "artifacts" VALUES('job_old',1,'range','52ec6586bc07f857c35afe4669b66cc211dfd4eba5978d2ed6db211f09f6054a',390590,'image/png');
INSERT INTO "artifacts" VALUES('job_old',1,'rgb','0f4690c1147cd3d19a28cc4e32346287ff6bd2af58cc560fbcc27e7efc186106',328519,'image/png');
INSERT INTO "artifacts" VALUES('job_old',2,'range','80308b81b1c9114edee6651f4104d9e8c0389ef0f82b0e01e05f635c6c62b8aa',375951,'image/png');
INSERT INTO "artifacts" VALUES('job_old',2,'rgb','af445cdac593505651f197af0f725757ef991288c9619d9cb64299eabfc2c212',360226,'image/png');
CREATE TABLE datasets (
    name         TEXT PRIMARY KEY,
    images       INTEGER NOT NULL DEFAULT 0,
    bytes        INTEGER NOT NULL DEFAULT 0, -- of artifacts, shared ones counted each time
    jobs         INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;
INSERT INTO "datasets" VALUES('bay',3,2156665,2);
CREATE TABLE failures (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    strikes      INTEGER NOT NULL,
    quarantined  INTEGER NOT NULL,           -- 1: given up, 0: will be tried again
    error        TEXT NOT NULL,              -- of the last attempt
    PRIMARY KEY (job_id, frame)
) STRICT, WITHOUT ROWID;
INSERT INTO "failures" VALUES('job_sad',0,3,1,'boom');
INSERT INTO "failures" VALUES('job_sad',1,3,1,'boom');
CREATE TABLE idempotency_keys (
    owner        TEXT NOT NULL,              -- hash of the caller's token: keys of different callers never meet
    key          TEXT NOT NULL,
    body_digest  TEXT NOT NULL,
    job_id       TEXT NOT NULL REFERENCES jobs (id),
    PRIMARY KEY (owner, key)
) STRICT, WITHOUT ROWID;
INSERT INTO "idempotency_keys" VALUES('me','k','d','job_old');
CREATE TABLE images (
    job_id       TEXT NOT NULL REFERENCES jobs (id),
    frame        INTEGER NOT NULL,
    dataset      TEXT NOT NULL,
    created_ms   INTEGER NOT NULL,
    digest       TEXT NOT NULL,              -- of the frame: parameters and artifacts
    record       TEXT NOT NULL, "scene.kind" TEXT, "scene.family" TEXT, "scene.seed" REAL, "scene.id" TEXT, "camera.width" REAL, "camera.height" REAL, "camera.hfov_deg" REAL, "water.optics" TEXT, "water.range_scale" REAL, "water.depth_m" REAL, "water.ambient" TEXT, "water.style" TEXT, "alpha" REAL, "lights.count" REAL, "fidelity.tolerance" REAL, "fidelity.terms" REAL, "fidelity.variant" TEXT, "seed" REAL, "absorption_per_m.r" REAL, "absorption_per_m.g" REAL, "absorption_per_m.b" REAL, "scattering_per_m.r" REAL, "scattering_per_m.g" REAL, "scattering_per_m.b" REAL, "beam_attenuation_per_m.r" REAL, "beam_attenuation_per_m.g" REAL, "beam_attenuation_per_m.b" REAL, "backscatter_attenuation_per_m.r" REAL, "backscatter_attenuation_per_m.g" REAL, "backscatter_attenuation_per_m.b" REAL, "diffuse_attenuation_per_m.r" REAL, "diffuse_attenuation_per_m.g" REAL, "diffuse_attenuation_per_m.b" REAL, "veiling_light.r" REAL, "veiling_light.g" REAL, "veiling_light.b" REAL, "g_per_m.r" REAL, "g_per_m.g" REAL, "g_per_m.b" REAL, "spread_px_per_m.r" REAL, "spread_px_per_m.g" REAL, "spread_px_per_m.b" REAL, "holes" REAL, "negative_radiance" REAL, "clamped" REAL, "range_saturated" REAL, "total_ms" REAL, "code_version" TEXT, "onnx_runtime" TEXT, "cpu_features" TEXT,              -- everything known about the image, as JSON
    PRIMARY KEY (job_id, frame)              -- a repeated commit finds its row
) STRICT;
INSERT INTO "images" VALUES('job_old',0,'bay',2000,'4d4475f0696f4e121b703e96b642134e060c41ba7b4e7d9c2e3c2632e357bb55','{"artifacts":[{"bytes":355700,"digest":"05c811324a03872f665c37d4afdf00d308b1d7d46a3613f428f2efe3c5d8f649","kind":"rgb","media_type":"image/png"},{"bytes":345679,"digest":"c17bfe9bfaf5969f24d234e7706ca06b208fa305cae1c79140f58b016b7009d0","kind":"range","media_type":"image/png"}],"counts":{"clamped":0,"holes":90,"negative_radiance":0,"range_saturated":0},"frame":0,"measurements":{"hscm":{"entropy":0.8540949858523311,"uciqe":0.6774891057974435,"uicm":0.2721420773621856,"uiconm":0.034032606111424356,"uiqm":0.3812460809305411,"uism":0.27900648168270054},"rgb":{"entropy":0.33763425352680126,"uciqe":0.8427316259520788,"uicm":0.7832045854337143,"uiconm":0.008664254618034847,"uiqm":0.7476109626366422,"uism":0.7257722316381265}},"optics":{"absorption_per_m":[0.3964679756288136,0.761034421627627,0.5239505916549513],"backscatter_attenuation_per_m":[0.844155142864354,0.8554897408612718,0.6602102858234031],"beam_attenuation_per_m":[0.488914630482505,0.7648786940076189,0.2046953217391707],"diffuse_attenuation_per_m":[0.9295340685764948,0.32924525963228174,0.8651734490315464],"g_per_m":[0.636484007282307,0.9309404776570788,0.943013365950674],"scattering_per_m":[0.5551675161334325,0.7082223347395467,0.518482183942174],"veiling_light":[0.5756608810873314,0.41296665290623197,0.25321380549383515]},"parameters":{"alpha":0.43152799704851,"artifacts":["rgb","range"],"camera":{"height":492,"hfov_deg":80.0,"width":768},"encode":{"format":"png"},"enhance":["hscm"],"fidelity":{"tolerance":0.0003},"frame":0,"labels":{"run":"job_old"},"lights":[{"color":[1,1,1],"intensity":0.771546556331567,"kind":"haze","size":0.2,"x":0.17386786595968287,"y":1.0}],"metrics":["entropy","uicm","uism","uiconm","uiqm","uciqe"],"scene":{"family":"shaft","kind":"procedural","seed":545679},"seed":42,"water":{"optics":{"preset":"jerlov-5C"},"range_scale":0.6595200373508188,"style":"atlantic"}},"plan":{"forward_scatter":{"bound":0.00027,"skipped":false,"terms":8},"style":{"skipped":false}},"provenance":{"code_version":"0.1.0","cpu_features":"avx2,fma","inputs":{},"onnx_runtime":null},"timings_ms":{"encode":18.808002906518357,"enhance":78.64192356357897,"haze":1.4992018029993788,"measure":60.58566445756778,"scene":89.01038420509421,"style":12.73333699975527,"total":80.96395937052264,"water":87.16818612795734},"warnings":[]}','procedural','shaft',545679.0,NULL,768.0,492.0,80.0,'jerlov-5C',6.59520037350818766341e-01,NULL,NULL,'atlantic',0.43152799704851,1.0,0.0003,NULL,NULL,42.0,3.96467975628813584787e-01,0.761034421627627,5.23950591654951280951e-01,5.55167516133432514813e-01,7.08222334739546655058e-01,0.518482183942174,0.488914630482505,7.64878694007618875616e-01,2.04695321739170710273e-01,0.844155142864354,8.55489740861271830141e-01,6.60210285823403131288e-01,9.2953406857649478745e-01,3.29245259632281739303e-01,8.65173449031546359933e-01,5.75660881087331377514e-01,4.12966652906231967978e-01,2.53213805493835153459e-01,0.636484007282307,9.30940477657078768736e-01,0.943013365950674,NULL,NULL,NULL,90.0,0.0,0.0,0.0,8.09639593705226445763e+01,'0.1.0',NULL,'avx2,fma');
INSERT INTO "images" VALUES('job_old',1,'bay',2001,'9a4e6c01e563a7b7e8a47b7f96508a347b4655f0af162c6d4f18dfe91094199f','{"artifacts":[{"bytes":328519,"digest":"0f4690c1147cd3d19a28cc4e32346287ff6bd2af58cc560fbcc27e7efc186106","kind":"rgb","media_type":"image/png"},{"bytes":390590,"digest":"52ec6586bc07f857c35afe4669b66cc211dfd4eba5978d2ed6db211f09f6054a","kind":"range","media_type":"image/png"}],"counts":{"clamped":0,"holes":582,"negative_radiance":0,"range_saturated":0},"frame":1,"measurements":{"hscm":{"entropy":0.7191946643336365,"uciqe":0.5972474253886875,"uicm":0.485501749500178,"uiconm":0.8490972532881906,"uiqm":0.4820606970851149,"uism":0.5175433454228353},"rgb":{"entropy":0.13170034420191254,"uciqe":0.4796705758325127,"uicm":0.41039963505183225,"uiconm":0.6738629751804336,"uiqm":0.06295097841371615,"uism":0.4278618508948223}},"optics":{"absorption_per_m":[0.4041421690502258,0.6054203689753291,0.45493790747028967],"backscatter_attenuation_per_m":[0.8843245635397899,0.06596019314557654,0.08141465400346089],"beam_attenuation_per_m":[0.645334640219506,0.8153505833680997,0.6817049733805886],"diffuse_attenuation_per_m":[0.4958799515892045,0.1231088869380522,0.2869113548237391],"g_per_m":[0.04374827567185875,0.9977478925366422,0.5978521730455875],"scattering_per_m":[0.5300789975015889,0.43596539982472515,0.16703498914055107],"veiling_light":[0.04790118284424137,0.5155198964114704,0.713770802843264]},"parameters":{"alpha":0.7457817572627012,"artifacts":["rgb","range"],"camera":{"height":492,"hfov_deg":80.0,"width":768},"encode":{"format":"png"},"enhance":["hscm"],"fidelity":{"tolerance":0.0003},"frame":1,"labels":{"run":"job_old"},"lights":[{"color":[1,1,1],"intensity":0.5230671798509815,"kind":"haze","size":0.2,"x":0.8773486867641731,"y":1.0}],"metrics":["entropy","uicm","uism","uiconm","uiqm","uciqe"],"scene":{"family":"shaft","kind":"procedural","seed":890590},"seed":42,"water":{"optics":{"preset":"jerlov-9C"},"range_scale":1.1663970512395372,"style":"muddy"}},"plan":{"forward_scatter":{"bound":0.00027,"skipped":false,"terms":8},"style":{"skipped":false}},"provenance":{"code_version":"0.1.0","cpu_features":"avx2,fma","inputs":{},"onnx_runtime":null},"timings_ms":{"encode":60.70497347052902,"enhance":39.36621572469054,"haze":94.0173917488018,"measure":8.773083406351363,"scene":30.185627552393875,"style":32.56836507329513,"total":15.54775011689123,"water":13.158494171175313},"warnings":[]}','procedural','shaft',890590.0,NULL,768.0,492.0,80.0,'jerlov-9C',1.1663970512395371859e+00,NULL,NULL,'muddy',7.45781757262701239241e-01,1.0,0.0003,NULL,NULL,42.0,4.04142169050225819049e-01,6.05420368975329137306e-01,4.54937907470289670808e-01,5.30078997501588933261e-01,4.35965399824725152733e-01,1.67034989140551065611e-01,0.645334640219506,8.15350583368099735004e-01,6.81704973380588552522e-01,8.843245635397899429e-01,6.59601931455765372325e-02,8.14146540034608873215e-02,4.95879951589204504003e-01,1.23108886938052206061e-01,2.86911354823739084274e-01,4.79011828442413717388e-02,5.15519896411470446295e-01,0.713770802843264,4.37482756718587523225e-02,9.97747892536642200234e-01,5.97852173045587464983e-01,NULL,NULL,NULL,582.0,0.0,0.0,0.0,1.55477501168912297653e+01,'0.1.0',NULL,'avx2,fma');
INSERT INTO "images" VALUES('job_old',2,'bay',2002,'f5c48c15be3f6d1c344d3bd3c5d8d4ca7f818e1d24c5ae0924e79cdd27fed03d','{"artifacts":[{"bytes":360226,"digest":"af445cdac593505651f197af0f725757ef991288c9619d9cb64299eabfc2c212","kind":"rgb","media_type":"image/png"},{"bytes":375951,"digest":"80308b81b1c9114edee6651f4104d9e8c0389ef0f82b0e01e05f635c6c62b8aa","kind":"range","media_type":"image/png"}],"counts":{"clamped":0,"holes":678,"negative_radiance":0,"range_saturated":0},"frame":2,"measurements":{"hscm":{"entropy":0.4797328060214607,"uciqe":0.71581463848262,"uicm":0.0720717397751525,"uiconm":0.06335216552938978,"uiqm":0.9535312176089886,"uism":0.13516164290574917},"rgb":{"entropy":0.0778721346387453,"uciqe":0.22411593375008018,"uicm":0.17159478245145107,"uiconm":0.1395266287144075,"uiqm":0.659588115057376,"uism":0.4146754119490282}},"optics":{"absorption_per_m":[0.33948162778023383,0.437826196941144,0.5557914202524366],"backscatter_attenuation_per_m":[0.21018872661631813,0.04819950701220109,0.5274120331768635],"beam_attenuation_per_m":[0.20013456805973429,0.3642315819574227,0.3778255680605133],"diffuse_attenuation_per_m":[0.38100694924428835,0.33068864476965193,0.9161947557847904],"g_per_m":[0.01165956213644691,0.3008853208999562,0.8671394089947767],"scattering_per_m":[0.3738033805791898,0.9320010634115916,0.20339098016743476],"veiling_light":[0.7402451511431978,0.525235701794198,0.6197713870081466]},"parameters":{"alpha":0.7491496838738247,"artifacts":["rgb","range"],"camera":{"height":492,"hfov_deg":80.0,"width":768},"encode":{"format":"png"},"enhance":["hscm"],"fidelity":{"tolerance":0.0003},"frame":2,"labels":{"run":"job_old"},"lights":[{"color":[1,1,1],"intensity":0.7390873243475792,"kind":"haze","size":0.2,"x":0.7263536145167478,"y":1.0}],"metrics":["entropy","uicm","uism","uiconm","uiqm","uciqe"],"scene":{"family":"shaft","kind":"procedural","seed":275951},"seed":42,"water":{"optics":{"preset":"jerlov-1C"},"range_scale":0.9673830307716712,"style":"atlantic"}},"plan":{"forward_scatter":{"bound":0.00027,"skipped":false,"terms":8},"style":{"skipped":false}},"provenance":{"code_version":"0.1.0","cpu_features":"avx2,fma","inputs":{},"onnx_runtime":null},"timings_ms":{"encode":59.59855338311283,"enhance":59.970664022330524,"haze":59.46335358835769,"measure":23.136182938450887,"scene":47.11635903272433,"style":31.77691225255112,"total":35.607347223444954,"water":75.16132355242914},"warnings":[]}','procedural','shaft',275951.0,NULL,768.0,492.0,80.0,'jerlov-1C',9.67383030771671204028e-01,NULL,NULL,'atlantic',7.49149683873824745461e-01,1.0,0.0003,NULL,NULL,42.0,3.39481627780233830016e-01,0.437826196941144,5.55791420252436552118e-01,3.73803380579189825638e-01,9.32001063411591612606e-01,2.03390980167434759495e-01,2.0013456805973428576e-01,3.64231581957422723139e-01,3.77825568060513317103e-01,2.10188726616318127815e-01,4.8199507012201089906e-02,5.27412033176863470629e-01,3.81006949244288350975e-01,3.30688644769651929333e-01,9.16194755784790371144e-01,7.40245151143197777088e-01,0.525235701794198,6.19771387008146601438e-01,1.16595621364469093778e-02,3.00885320899956176798e-01,8.67139408994776705874e-01,NULL,NULL,NULL,678.0,0.0,0.0,0.0,3.56073472234449539541e+01,'0.1.0',NULL,'avx2,fma');
CREATE TABLE jobs (
    id           TEXT PRIMARY KEY,          -- job_ and a UUIDv7, so that the order of ids is the order of arrival
    dataset      TEXT NOT NULL,
    spec         TEXT NOT NULL,             -- canonical description; frames are a formula of it until they have an image
    spec_digest  TEXT NOT NULL,
    frames       INTEGER NOT NULL,
    priority     INTEGER NOT NULL,
    -- queued: no frame has ended yet. running: some have. paused: nothing is offered for now. cancelled: by the user,
    -- what is there stays. done: every frame has its image. done_with_failures: some frames were given up.
    state        TEXT NOT NULL CHECK (state IN ('queued', 'running', 'paused', 'cancelled', 'done', 'done_with_failures')),
    done         INTEGER NOT NULL DEFAULT 0,
    failed       INTEGER NOT NULL DEFAULT 0,
    version      INTEGER NOT NULL DEFAULT 1, -- grows with every change; long-polls wait for it
    digest       TEXT,                       -- over all frames, once the job is done
    created_ms   INTEGER NOT NULL,
    started_ms   INTEGER,
    finished_ms  INTEGER
) STRICT;
INSERT INTO "jobs" VALUES('job_old','bay','{"count":4,"dataset":"bay","labels":{"run":"job_old"},"scene":{"family":"shaft","kind":"procedural","seed":{"int":[0,1000000]}},"seed":42}','0000000000000000000000000000000000000000000000000000000000000000',4,0,'running',3,0,5,NULL,1000,2000,NULL);
INSERT INTO "jobs" VALUES('job_sad','bay','{"count":4,"dataset":"bay","labels":{"run":"job_old"},"scene":{"family":"shaft","kind":"procedural","seed":{"int":[0,1000000]}},"seed":42}','1111111111111111111111111111111111111111111111111111111111111111',2,1,'done_with_failures',0,2,4,NULL,1100,NULL,1200);
CREATE TABLE measurements (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    subject      TEXT NOT NULL, "entropy" REAL, "uicm" REAL, "uism" REAL, "uiconm" REAL, "uiqm" REAL, "uciqe" REAL,              -- what was measured: rgb, or the method of an enhanced picture
    PRIMARY KEY (job_id, frame, subject)
) STRICT, WITHOUT ROWID;
INSERT INTO "measurements" VALUES('job_old',0,'hscm',8.54094985852331123332e-01,2.72142077362185597078e-01,2.79006481682700535618e-01,3.40326061114243558214e-02,3.81246080930541075826e-01,6.77489105797443480483e-01);
INSERT INTO "measurements" VALUES('job_old',0,'rgb',3.37634253526801264566e-01,7.83204585433714295383e-01,7.25772231638126541497e-01,8.66425461803484696365e-03,7.47610962636642173428e-01,8.42731625952078844399e-01);
INSERT INTO "measurements" VALUES('job_old',1,'hscm',7.19194664333636546338e-01,0.485501749500178,5.17543345422835310287e-01,8.49097253288190634279e-01,4.82060697085114897575e-01,5.97247425388687469549e-01);
INSERT INTO "measurements" VALUES('job_old',1,'rgb',1.3170034420191253921e-01,4.10399635051832245569e-01,4.2786185089482231536e-01,6.73862975180433587674e-01,6.29509784137161493289e-02,4.79670575832512713354e-01);
INSERT INTO "measurements" VALUES('job_old',2,'hscm',4.79732806021460678191e-01,0.0720717397751525,1.35161642905749168619e-01,6.335216552938978396e-02,9.53531217608988623801e-01,0.71581463848262);
INSERT INTO "measurements" VALUES('job_old',2,'rgb',0.0778721346387453,1.71594782451451072224e-01,4.14675411949028183133e-01,1.3952662871440749126e-01,0.659588115057376,2.24115933750080181807e-01);
CREATE TABLE scenes (
    id               TEXT PRIMARY KEY,
    content_digest   TEXT NOT NULL UNIQUE,   -- the same content is the same scene
    rgb_digest       TEXT NOT NULL,
    range_digest     TEXT,
    range_kind       TEXT CHECK (range_kind IN ('range', 'z_depth')), -- range: along the ray; z_depth: along the axis
    unit_m           REAL,
    invalid_code     INTEGER,
    instances_digest TEXT,
    width            INTEGER NOT NULL,
    height           INTEGER NOT NULL,
    focal_px         REAL,
    cx               REAL,
    cy               REAL,
    created_ms       INTEGER NOT NULL
) STRICT;
INSERT INTO "scenes" VALUES('scn_1','cccccccccccccccccccccccccccccccccccccccccccccccccccccccccccccccc','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',NULL,NULL,NULL,NULL,NULL,4,3,NULL,NULL,NULL,900);
CREATE INDEX jobs_by_dataset ON jobs (dataset, id);
CREATE INDEX jobs_open ON jobs (id) WHERE state IN ('queued', 'running', 'paused');
CREATE INDEX images_by_dataset ON images (dataset, job_id, frame);
COMMIT;
