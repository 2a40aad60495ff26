#include <isoatlas/isoatlas.h>

#include <iostream>
#include <vector>

int main() {
  std::vector<float> s(27,0.f); s[13]=1;
  isoatlas::VolumeView v; v.grid.size={3,3,3}; v.samples=s.data();
  isoatlas::ExtractOptions o; o.isovalue=0.5;
  const auto mesh = isoatlas::extract(v,o).mesh();
  std::cout << mesh.triangles.size() << " triangles\n";
  try { o.isovalue=5; isoatlas::extract(v,o); } catch (const isoatlas::Error& e) { std::cout << e.what() << "\n"; }
}
