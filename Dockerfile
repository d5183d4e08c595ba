# Service and workers from one image; ONNX Runtime lies beside the binary, where it is looked for.
FROM rust:1-bookworm AS build
RUN apt-get update && apt-get install -y --no-install-recommends python3 python3-pip && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY Cargo.toml Cargo.lock clippy.toml rustfmt.toml ./
COPY .cargo .cargo
COPY bindings bindings
COPY examples examples
COPY lab lab
COPY migrations migrations
COPY models models
COPY proto proto
COPY scripts scripts
COPY services services
COPY tests tests
COPY workers workers
RUN scripts/get-onnxruntime.sh /opt/onnxruntime
RUN cargo build --release --locked -p cli --bin fathom

FROM debian:bookworm-slim
RUN apt-get update && apt-get install -y --no-install-recommends curl libstdc++6 && rm -rf /var/lib/apt/lists/* \
    && useradd --create-home fathom && mkdir /data && chown fathom /data
COPY --from=build /src/target/release/fathom /usr/local/bin/
COPY --from=build /opt/onnxruntime /opt/onnxruntime
ENV FATHOM_ONNXRUNTIME=/opt/onnxruntime/libonnxruntime.so
USER fathom
VOLUME /data
EXPOSE 7311
ENTRYPOINT ["/usr/local/bin/fathom"]
CMD ["serve", "--data", "/data"]
