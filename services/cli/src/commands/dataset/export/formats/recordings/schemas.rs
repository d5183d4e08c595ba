//! Definitions of the messages of ROS 2, as `ros2msg` schemas: the type, then the types that it uses.

/// A type of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MessageType {
    Image,
    CompressedImage,
    CameraInfo,
    PoseStamped,
    TfMessage,
}

const HEADER: &str = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
const TIME: &str = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const REGION: &str = "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n";
const POSE: &str =
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
const POINT: &str = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
const QUATERNION: &str =
    "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const TRANSFORM_STAMPED: &str = "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n\
    geometry_msgs/Transform transform\n";
const TRANSFORM: &str =
    "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n";
const VECTOR: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

impl MessageType {
    pub(super) const ALL: [Self; 5] = [
        Self::Image,
        Self::CompressedImage,
        Self::CameraInfo,
        Self::PoseStamped,
        Self::TfMessage,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Image => "sensor_msgs/msg/Image",
            Self::CompressedImage => "sensor_msgs/msg/CompressedImage",
            Self::CameraInfo => "sensor_msgs/msg/CameraInfo",
            Self::PoseStamped => "geometry_msgs/msg/PoseStamped",
            Self::TfMessage => "tf2_msgs/msg/TFMessage",
        }
    }

    /// The definition with those of the types that it uses.
    pub(super) fn definition(self) -> String {
        let (fields, used): (&str, &[&str]) = match self {
            Self::Image => (
                "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
                &[HEADER, TIME],
            ),
            Self::CompressedImage => (
                "std_msgs/Header header\nstring format\nuint8[] data\n",
                &[HEADER, TIME],
            ),
            Self::CameraInfo => (
                "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n\
                 float64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
                &[HEADER, TIME, REGION],
            ),
            Self::PoseStamped => (
                "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                &[HEADER, TIME, POSE, POINT, QUATERNION],
            ),
            Self::TfMessage => (
                "geometry_msgs/TransformStamped[] transforms\n",
                &[TRANSFORM_STAMPED, HEADER, TIME, TRANSFORM, VECTOR, QUATERNION],
            ),
        };
        let line = "=".repeat(80) + "\n";
        let parts: Vec<&str> = std::iter::once(fields).chain(used.iter().copied()).collect();
        parts.join(&line)
    }
}
