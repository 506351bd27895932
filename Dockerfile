# docker build -t lensproof . && docker run --rm -v "$PWD:/work" lensproof demo
FROM debian:12 AS build
RUN apt-get update
COPY . /source
RUN /source/lensproof package

FROM debian:12
COPY --from=build /source/output/packages/lensproof_*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/lensproof_*.deb \
    && rm -rf /tmp/lensproof_*.deb /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["lensproof"]
