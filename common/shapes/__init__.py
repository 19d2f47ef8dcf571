"""What obstacles are made of: one small file a shape, exact distances, how obstacles move, spheres that cover them."""
