// A second symbol that other libraries could bind to.
extern "C" __attribute__((visibility("default"))) int forgotten_helper() {
  return 1;
}
