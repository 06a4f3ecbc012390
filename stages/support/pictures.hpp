// Declares the pictures that stages draw, which are compiled once for all of them (support/pictures.cpp,
// support/any_pictures.cpp), so that a stage's own source compiles in about a second. Tests draw them by the
// library's render alone.
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/protostar.hpp>

#include "stage_render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

extern template void render(Image&, const Camera&, const Scene<Sphere>&, const BinaryIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const ColorIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const DepthIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const DiffuseIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const NormalIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const ShadowIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const TransparencyIntegrator&,
                            const RenderOptions&);

extern template void render(Image&, const Camera&, const AnyScene&, const BinaryIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const ColorIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const DepthIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const DiffuseIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const NormalIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const ShadowIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const TransparencyIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const WhittedIntegrator&,
                            const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::BinaryIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::ColorIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::DepthIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::DiffuseIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::NormalIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::ShadowIntegrator>;
extern template struct StagePicture<protostar::Scene<protostar::Sphere>, protostar::TransparencyIntegrator>;

extern template struct StagePicture<protostar::AnyScene, protostar::BinaryIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::ColorIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::DepthIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::DiffuseIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::NormalIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::ShadowIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::TransparencyIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::WhittedIntegrator>;
