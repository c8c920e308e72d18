#include <assimp/BaseImporter.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/scene.h>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vbond/setup/mesh_file.hpp"
#include "vbond/setup/polygons.hpp"

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

std::string extension_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::stl: return ".stl";
    case MeshFormat::obj: return ".obj";
    case MeshFormat::ply: return ".ply";
  }
  return "";
}

void add(const aiMesh& from, MeshFile& to) {
  const std::size_t first = to.mesh.corners.size();
  if (first + from.mNumVertices > 0xFFFFFFFFu) throw std::runtime_error("it has more than 2^32 corners");
  for (unsigned k = 0; k < from.mNumVertices; ++k)
    to.mesh.corners.push_back({from.mVertices[k].x, from.mVertices[k].y, from.mVertices[k].z});
  std::vector<std::uint32_t> polygon;
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    polygon.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= from.mNumVertices)
        throw std::runtime_error("a face has a corner that is not there");
      polygon.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
    }
    if (polygon.size() < 3) {
      ++to.other;
      continue;
    }
    if (const std::string reason = cut_polygon(to.mesh.corners, polygon, to.mesh.triangles); !reason.empty())
      throw std::runtime_error(reason);
  }
}

/// Leaves the reader of one format: Assimp would try its forty others on what this one refuses.
void keep_only(const char* extension, Assimp::Importer& importer) {
  const std::size_t kept = importer.GetImporterIndex(extension);
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    if (k == kept) continue;
    const std::unique_ptr<Assimp::BaseImporter> reader(importer.GetImporter(k));
    importer.UnregisterLoader(reader.get());  // which does not delete it
  }
}

}  // namespace

MeshFile import_mesh(std::string_view content, MeshFormat format) {
  MeshFile file;
  try {
    Assimp::Importer importer;
    const std::string name = "mesh" + extension_of(format);
    keep_only(extension_of(format).c_str(), importer);
    importer.SetIOHandler(new OneFile(name, content));  // which deletes it
    // No steps after reading: in Debian's build some end the program where a file is wrong.
    const aiScene* const scene = importer.ReadFile(name, 0);
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
