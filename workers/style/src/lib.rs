//! Style water models: ONNX networks that repaint a frame in the look of one water.
