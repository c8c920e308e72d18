#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include <memory>
#include <stdexcept>

#include "vbond/build/mesh_file.hpp"

/// The only place that knows Assimp.
namespace vbond {
namespace {

/// Shows one file and nothing else: what an OBJ file names besides (materials, pictures) is not looked for.
class OneFile final : public Assimp::IOSystem {
 public:
  OneFile(std::string name, std::string_view content) : name_(std::move(name)), content_(content) {}
  bool Exists(const char* file) const override { return name_ == file; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (!Exists(file)) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()),
                                      content_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string name_;
  std::string_view content_;
};

const char* name_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::stl: return "mesh.stl";
    case MeshFormat::obj: return "mesh.obj";
    case MeshFormat::ply: return "mesh.ply";
  }
  return "";
}

void add(const aiMesh& from, MeshFile& to) {
  const std::size_t first = to.mesh.corners.size();
  if (first + from.mNumVertices > 0xFFFFFFFFu) throw std::runtime_error("it has more than 2^32 corners");
  for (unsigned k = 0; k < from.mNumVertices; ++k)
    to.mesh.corners.push_back({from.mVertices[k].x, from.mVertices[k].y, from.mVertices[k].z});
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) {
      ++to.other;
      continue;
    }
    std::array<std::uint32_t, 3> triangle;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= from.mNumVertices)
        throw std::runtime_error("a face has a corner that is not there");
      triangle[k] = static_cast<std::uint32_t>(first + face.mIndices[k]);
    }
    to.mesh.triangles.push_back(triangle);
  }
}

}  // namespace

MeshFile import_mesh(std::string_view content, MeshFormat format) {
  MeshFile file;
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new OneFile(name_of(format), content));  // which deletes it
    const aiScene* const scene =
        importer.ReadFile(name_of(format), aiProcess_ValidateDataStructure | aiProcess_Triangulate);
    if (scene == nullptr) throw std::runtime_error(importer.GetErrorString());
    for (unsigned k = 0; k < scene->mNumMeshes; ++k) add(*scene->mMeshes[k], file);
  } catch (const std::runtime_error&) {
    throw;
  } catch (const std::exception& e) {  // of memory or of Assimp's own
    throw std::runtime_error(e.what());
  } catch (...) {
    throw std::runtime_error("it could not be taken apart");
  }
  return file;
}

}  // namespace vbond
